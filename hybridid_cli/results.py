"""Results as a person reads them: tables of records, estimates and scores, and where the files went."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rich.console import RenderableType
from rich.text import Text

from hybridid.quantities import fixed, mean_square, number, quantity, r_squared
from hybridid_cli.residual_results import residual_results
from hybridid_cli.tables import rendered, table
from hybridid_cli.trace_results import trace_results
from pipelines.shared.findings import estimate_of, metric_rows, prepared_records
from pipelines.shared.stage import Outcome


def summary(outcome: Outcome, command: str) -> str:
    """What ``command`` found, as text: one table a stage, then the tree."""
    shown = outcome.stages if command == "run" else (command,)
    parts = [part for name in shown for part in _SECTIONS[name](outcome.tree)]
    return rendered([*parts, Text(f"files: {outcome.tree}")])


def _records(tree: Path) -> list[RenderableType]:
    columns = [
        ("record", ""),
        ("role", ""),
        ("samples", "right"),
        ("rate", "right"),
        ("data", ""),
        ("from", ""),
    ]
    made = table("Records", columns)
    notes: list[RenderableType] = []
    for row in (record.row for record in prepared_records(tree)):
        rate = f"{1 / row['dt']:.6g} Hz"
        made.add_row(row["name"], row["role"], str(row["n"]), rate, _provenance(row), row["source"])
        notes += [Text(f"WARNING: record {row['name']}: {line}", style="yellow") for line in row["warnings"]]
    return [made, *notes]


def _estimates(tree: Path) -> list[RenderableType]:
    estimate = estimate_of(tree)
    fitted = ", ".join(estimate["records"])
    columns = [
        ("parameter", ""),
        ("value", "right"),
        ("std", "right"),
        ("unit", ""),
        ("bounds", ""),
        ("", ""),
    ]
    made = table(f"Estimates from {fitted} ({estimate['provenance']})", columns)
    for name, p in estimate["parameters"].items():
        bounds = f"[{number(p['lower'], 6, '−∞')}, {number(p['upper'], 6, '∞')}]"
        made.add_row(name, number(p["value"], 6), number(p["std"], 2), p["unit"], bounds, _flags(p))
    seconds = estimate["seconds"]
    line = (
        f"{estimate['status']} after {estimate['iterations']} iterations on {estimate['provenance']} data, "
        f"cost {number(estimate['cost'], 6)}, build {seconds['build']:.2f} s, solve {seconds['solve']:.2f} s"
    )
    lines: list[RenderableType] = [made, Text(line)]
    if not estimate["converged"]:
        lines.append(
            Text("NOT CONVERGED: these numbers are where the solver stopped, no optimum", style="bold red")
        )
    return lines + [Text(f"WARNING: {warning}", style="yellow") for warning in estimate["warnings"]]


def _flags(parameter: dict[str, Any]) -> Text:
    flags = [
        word
        for word, on in (
            ("AT BOUND", parameter["at_bound"]),
            ("NOT IDENTIFIABLE", not parameter["identifiable"]),
        )
        if on
    ]
    return Text(", ".join(flags), style="bold red")


def _scores(tree: Path) -> list[RenderableType]:
    rows = metric_rows(tree)
    several = len({row["model"] for row in rows}) > 1
    names = [(name, "") for name in (*(("model",) if several else ()), "record", "output", "view")]
    scores = [(name, "right") for name in ("RMSE", "MSE", "R²", "fit %", "n")]
    made = table("Scores", [*names, *scores, ("data", "")])
    for row in rows:
        made.add_row(
            *((row["model"],) if several else ()),
            row["record"],
            row["output"],
            _view(row),
            quantity(row["rmse"], row["unit"]),
            mean_square(row["mse"], row["unit"]),
            r_squared(row["r2"]),
            fixed(row["fit_percent"], 2, missing=""),
            str(row["n"]),
            _provenance(row),
        )
    return [made]


def _view(row: dict[str, Any]) -> str:
    return f"horizon {row['horizon']:g} s" if row["view"] == "horizon" else "free run"


def _figures(tree: Path) -> list[RenderableType]:
    files = sorted(p.relative_to(tree) for p in (tree / "plot").iterdir() if p.suffix == ".png") or sorted(
        p.relative_to(tree) for p in (tree / "plot").iterdir() if p.suffix != ".json"
    )
    return [Text("Figures", style="bold"), *(Text(f"  {path}") for path in files), Text("")]


def _provenance(row: Mapping[str, Any]) -> Text:
    return Text(row["provenance"], style="bold magenta" if row["provenance"] == "simulated" else "")


_SECTIONS: dict[str, Callable[[Path], list[RenderableType]]] = {
    "preprocess": _records,
    "fit": _estimates,
    "residual": residual_results,
    "validate": _scores,
    "plot": _figures,
    "trace": trace_results,
}
