"""What ``residual`` found, as a person reads it: networks tried, the one kept, its explained share."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import RenderableType
from rich.text import Text

from hybridid.quantities import percent, quantity
from hybridid_cli.tables import table
from pipelines.shared.findings import residual_of


def residual_results(tree: Path) -> list[RenderableType]:
    """Tables of the networks that were tried, then one line a finding."""
    found = residual_of(tree)
    fitted = f"{', '.join(found['records'])} ({found['provenance']})"
    parts: list[RenderableType] = []
    if found.get("candidates"):
        parts.append(_candidates(found, fitted))
    if found.get("networks"):
        parts.append(_networks(found, fitted))
    if found.get("rule"):
        parts.append(Text(f"rule: {found['rule']}"))
    line = f"{found['model']}, fitted to {fitted} in {found['seconds']:.1f} s"
    if "horizon" in found:
        span = "the whole record" if found["horizon"] is None else f"horizons of {found['horizon']} samples"
        line += f" over {span}, physics {found['physics']}"
    parts.append(Text(line))
    parts += [_explained(row) for row in found["explained"]]
    return parts + [Text(f"WARNING: {warning}", style="yellow") for warning in found["warnings"]]


def _candidates(found: Mapping[str, Any], fitted: str) -> RenderableType:
    columns = [
        ("nodes", "right"),
        ("horizon", "right"),
        ("held-out RMSE", "right"),
        ("gray box", "right"),
        ("", ""),
    ]
    made = table(f"Networks on held-out blocks of {fitted}", columns)
    for row in found["candidates"]:
        hybrid, gray = (_sizes(row[key], row["units"]) for key in ("rmse", "gray_rmse"))
        horizon = "record" if row["horizon"] is None else str(row["horizon"])
        note = "chosen" if row["chosen"] else "; ".join(row["failures"])
        made.add_row(str(row["nodes"]), horizon, hybrid, gray, note)
    return made


def _networks(found: Mapping[str, Any], fitted: str) -> RenderableType:
    """One row a size and output: the seed that held-out blocks prefer, and its hybrid on every record."""
    records = [(row["record"], row["fitted"]) for row in found["networks"][0]["hybrid"]]
    columns = [("output", ""), ("layers", ""), ("seed", "right"), ("weights", "right")]
    columns += [("held-out RMSE", "right"), ("without", "right")]
    columns += [(f"{name}{'' if seen else ', unseen'}", "right") for name, seen in records] + [("", "")]
    made = table(f"Networks running free, on held-out blocks of {fitted}; then the hybrid's RMSE", columns)
    for row in _best_seeds(found["networks"]):
        blocks = (quantity(row[key], row["unit"], missing="failed") for key in ("held_out", "without"))
        scores = (quantity(one["rmse"], row["unit"]) for one in row["hybrid"])
        size, note = f"{row['depth']} x {row['width']}", "kept" if row["chosen"] else ""
        made.add_row(row["output"], size, str(row["seed"]), str(row["weights"]), *blocks, *scores, note)
    for output in dict.fromkeys(row["output"] for row in found["gray"]):
        rows = [row for row in found["gray"] if row["output"] == output]
        scores = (quantity(row["rmse"], row.get("unit", "")) for row in rows)
        made.add_row(output, "gray box", "", "", "", "", *scores, "")
    return made


def _best_seeds(networks: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Of each output and size the network that is kept, or else the seed with the lowest held-out error."""
    best: dict[tuple[Any, ...], dict[str, Any]] = {}
    for row in networks:
        at = (row["output"], row["depth"], row["width"])
        if at not in best or _rank(row) < _rank(best[at]):
            best[at] = row
    return list(best.values())


def _rank(row: Mapping[str, Any]) -> tuple[bool, float]:
    return not row["chosen"], float("inf") if row["held_out"] is None else row["held_out"]


def _explained(row: Mapping[str, Any]) -> RenderableType:
    return Text(
        f"the model's own parameters could have explained {percent(row['share'], 0)} of the network's output "
        f"on {row['record']} ({row['provenance']})"
    )


def _sizes(values: list[float | None], units: list[str]) -> str:
    pairs = zip(values, units, strict=True)
    return ", ".join(quantity(value, unit, missing="failed") for value, unit in pairs)
