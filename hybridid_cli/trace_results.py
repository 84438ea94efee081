"""What a trace found, as a person reads it: the verdict first."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.console import RenderableType
from rich.text import Text

from hybridid.quantities import change, probability, quantity, r_squared, share
from hybridid_cli.tables import table
from pipelines.shared.findings import trace_of
from pipelines.trace.words import VERDICTS, estimates, outcome

_COLOURS = {"effect_found": "green", "ambiguous": "yellow", "nothing_missing": "green", "unexplained": "red"}


def trace_results(tree: Path) -> list[RenderableType]:
    """The verdict in one sentence, what was accepted, before and after, where the files are."""
    data = trace_of(tree)
    verdict = Text.assemble(
        (f"{VERDICTS[data['verdict']]}: ", f"bold {_COLOURS[data['verdict']]}"), data["sentence"], "\n"
    )
    parts: list[RenderableType] = [verdict]
    if data["accepted"]:
        parts.append(_accepted(data))
    parts.append(_before_after(data))
    if data["completeness"]:
        parts.append(_completeness(data))
    parts += [
        Text(
            f"tried {len(data['rejected']) + len(data['accepted'])} effects in {len(data['steps'])} steps, "
            f"{data['seconds']:.0f} s on {data['processes']} processes; {data['stopped']}"
        ),
        Text(f"report: {tree / 'trace' / 'report.html'}"),
    ]
    if data["accepted"]:
        parts.append(Text(f"go on:  {data['commands'][0]}"))
    return parts


def _accepted(data: dict[str, Any]) -> RenderableType:
    columns = [
        ("effect", ""), ("port", ""), ("estimate ± 95 %", ""), ("gain", "right"), ("adjusted p", "right"),
        ("cannot be told from", ""), ("survives", "right"),
    ]  # fmt: skip
    made = table(f"Accepted ({data['provenance']})", columns)
    for entry in data["accepted"]:
        survived = [s["survives"] for s in entry["survivals"] if s["simulated"]]
        made.add_row(
            entry["effect"],
            entry["port"],
            ", ".join(estimates(entry["parameters"])),
            share(entry["gain"]),
            probability(entry["p_value"]),
            ", ".join(name for name in entry["class"] if name != entry["effect"]) or "–",
            f"{sum(survived)} of {len(survived)} variations",
        )
    return made


def _before_after(data: dict[str, Any]) -> RenderableType:
    columns = [
        ("record", ""), ("output", ""), ("view", ""), ("network", ""),
        ("RMSE before", "right"), ("after", "right"),
        ("change", "right"), ("R² before", "right"), ("after", "right"), ("data", ""),
    ]  # fmt: skip
    made = table("Before and after", columns)
    for before, after in zip(data["before"], data["after"], strict=True):
        made.add_row(
            f"{before['record']} ({before['role']})",
            before["output"],
            "free run" if before["view"] == "free_run" else f"horizon {before['horizon']:g} s",
            "with" if before["network"] else "–",
            quantity(before["rmse"], before["unit"]),
            quantity(after["rmse"], after["unit"]),
            change(before["rmse"], after["rmse"]),
            r_squared(before["r2"]),
            r_squared(after["r2"]),
            Text(before["provenance"], style="bold magenta" if before["provenance"] == "simulated" else ""),
        )
    return made


def _completeness(data: dict[str, Any]) -> Text:
    check = data["completeness"]
    takes, took = (share(max(check[key], 0.0)) for key in ("gain", "gain_before"))
    return Text(
        f"completeness: a network ({check['network']}) takes {takes} from the held-out error that is left, "
        f"{took} from that before: {outcome(data)}"
    )
