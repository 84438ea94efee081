"""What ``residual`` found, as a person reads it: networks tried, the one kept, its explained share."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite
from pathlib import Path

from rich.console import RenderableType
from rich.text import Text

from hybridid.hybrid.report import CandidateScore, NARXReport, NetworkScore
from hybridid.quantities import percent, quantity
from hybridid.residuals.explained import Explained
from hybridid_cli.tables import table, warnings
from pipelines.shared.hybrids import residual_of


def residual_results(tree: Path) -> list[RenderableType]:
    """Tables of the networks that were tried, then one line a finding."""
    found = residual_of(tree)
    report = found.report
    fitted = f"{', '.join(found.records)} ({found.provenance})"
    parts: list[RenderableType] = []
    line = f"{found.model}, fitted to {fitted} in {report.seconds:.1f} s"
    if isinstance(report, NARXReport):
        parts.append(_networks(report, fitted))
    else:
        parts += [_candidates(report.candidates, fitted)] if report.candidates else []
        span = "the whole record" if report.horizon is None else f"horizons of {report.horizon} samples"
        line += f" over {span}, physics {report.physics}"
    if report.rule:
        parts.append(Text(f"rule: {report.rule}"))
    parts.append(Text(line))
    parts += [_explained(one) for one in found.explained]
    return parts + warnings(found.warnings)


def _candidates(candidates: Sequence[CandidateScore], fitted: str) -> RenderableType:
    columns = ("nodes", "horizon", "held-out RMSE", "gray box", "")
    made = table(f"Networks on held-out blocks of {fitted}", columns, words=(4,))
    for row in candidates:
        horizon = "record" if row.horizon is None else str(row.horizon)
        note = "chosen" if row.chosen else "; ".join(row.failures)
        errors = (_sizes(row.rmse, row.units), _sizes(row.gray_rmse, row.units))
        made.add_row(str(row.nodes), horizon, *errors, note)
    return made


def _networks(report: NARXReport, fitted: str) -> RenderableType:
    """One row a size and output: the seed that held-out blocks prefer, and its hybrid on every record."""
    records = [(one.record, one.fitted) for one in report.networks[0].hybrid]
    scored = [f"{name}{'' if seen else ', unseen'}" for name, seen in records]
    columns = ("output", "layers", "seed", "weights", "held-out RMSE", "without", *scored, "")
    title = f"Networks running free, on held-out blocks of {fitted}; then the hybrid's RMSE"
    made = table(title, columns, words=(0, 1, len(columns) - 1))
    for row in _best_seeds(report.networks):
        blocks = (quantity(value, row.unit, missing="failed") for value in (row.held_out, row.without))
        scores = (quantity(one.rmse, row.unit) for one in row.hybrid)
        size, note = f"{row.depth} x {row.width}", "kept" if row.chosen else ""
        made.add_row(row.output, size, str(row.seed), str(row.weights), *blocks, *scores, note)
    for output in dict.fromkeys(one.output for one in report.gray):
        scores = (quantity(one.rmse, one.unit) for one in report.gray if one.output == output)
        made.add_row(output, "gray box", "", "", "", "", *scores, "")
    return made


def _best_seeds(networks: Sequence[NetworkScore]) -> list[NetworkScore]:
    """Of each output and size the network that is kept, or else the seed with the lowest held-out error."""
    best: dict[tuple[str, int, int], NetworkScore] = {}
    for row in networks:
        at = (row.output, row.depth, row.width)
        if at not in best or _rank(row) < _rank(best[at]):
            best[at] = row
    return list(best.values())


def _rank(row: NetworkScore) -> tuple[bool, float]:
    return not row.chosen, row.held_out if isfinite(row.held_out) else inf


def _explained(one: Explained) -> RenderableType:
    return Text(
        f"the model's own parameters could have explained {percent(one.share, 0)} of the network's output "
        f"on {one.record} ({one.provenance})"
    )


def _sizes(values: Sequence[float], units: Sequence[str]) -> str:
    pairs = zip(values, units, strict=True)
    return ", ".join(quantity(value, unit, missing="failed") for value, unit in pairs)
