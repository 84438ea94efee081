"""What ``residual`` found, as a person reads it: networks tried, the one kept, its explained share."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import RenderableType
from rich.text import Text

from hybridid.plotting.units import engineering
from hybridid_cli.tables import table
from pipelines.findings import residual_of


def residual_results(tree: Path) -> list[RenderableType]:
    """Tables of the networks that were tried, then one line a finding."""
    found = residual_of(tree)
    fitted = f"{', '.join(found['records'])} ({found['provenance']})"
    parts: list[RenderableType] = []
    if found.get("candidates"):
        parts += [_candidates(found, fitted), Text(f"rule: {found['rule']}")]
    if found.get("networks"):
        parts.append(_networks(found, fitted))
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
    columns = [("output", ""), ("seed", "right"), ("weights", "right")]
    columns += [("held-out RMSE", "right"), ("without", "right"), ("", "")]
    made = table(f"Networks running free, on held-out blocks of {fitted}", columns)
    for row in found["networks"]:
        hybrid, gray = (_sizes([row[key]], [row["unit"]]) for key in ("held_out", "without"))
        note = "kept" if row["chosen"] else ""
        made.add_row(row["output"], str(row["seed"]), str(row["weights"]), hybrid, gray, note)
    return made


def _explained(row: Mapping[str, Any]) -> RenderableType:
    return Text(
        f"the model's own parameters could have explained {row['share']:.0%} of the network's output "
        f"on {row['record']} ({row['provenance']})"
    )


def _sizes(values: list[float | None], units: list[str]) -> str:
    return ", ".join(_size(value, unit) for value, unit in zip(values, units, strict=True))


def _size(value: float | None, unit: str) -> str:
    if value is None:
        return "failed"
    factor, shown = engineering(value, unit)
    return f"{value * factor:.4g} {shown}"
