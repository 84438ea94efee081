"""The numbers and facts that a run tree holds, by the names under which MLflow keeps them."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from hybridid.hybrid.report import RBFReport
from hybridid.trace.results.result import Trace
from hybridid.validation import Metrics
from pipelines.shared.fitted import ESTIMATE, fit_of
from pipelines.shared.hybrids import Residual, residual_of
from pipelines.shared.predictions import metric_rows
from pipelines.shared.prepared import prepared_records
from pipelines.shared.traced import TRACE, trace_of


def metrics_of(tree: Path, stages: Sequence[str], trace: Path | None = None) -> dict[str, float]:
    """Every finite number found by ``stages``, by a name that says what it is.

    ``trace`` is the folder of the trace (None: the newest).
    """
    found: dict[str, float | None] = {}
    if "fit" in stages:
        estimate = fit_of(tree).estimate
        found |= {"fit.cost": estimate.cost, "fit.iterations": estimate.iterations}
        found |= {f"fit.seconds.{name}": value for name, value in estimate.seconds.items()}
        for p in estimate.parameters:
            name = _without_brackets(p.name)
            found |= {f"parameter.{name}": p.value, f"std.{name}": p.std}
        for one in estimate.differences:
            found |= {f"spread.{one.parameter}": one.spread, f"one_value.{one.parameter}": one.test.p_value}
    if "validate" in stages:
        gray = fit_of(tree).model
        for row in metric_rows(tree):
            where = f"{row.record}.{row.output}.{row.view}"
            where = where if row.model == gray else f"hybrid.{where}"
            found |= _measures(where, row) | {f"{where}.fit_percent": row.fit_percent}
    if "residual" in stages:
        found |= _residual_metrics(residual_of(tree))
    if "trace" in stages:
        found |= _trace_metrics(trace_of(tree, trace).found)
    return {name: float(value) for name, value in found.items() if value is not None and isfinite(value)}


def _without_brackets(name: str) -> str:
    """``f_c.cold`` for f_c[cold]: MLflow takes no brackets."""
    return name.replace("[", ".").replace("]", "")


def _residual_metrics(residual: Residual) -> dict[str, float]:
    """Each network's held-out error, and how much of the network physics could have explained."""
    report = residual.report
    found = {"residual.seconds": report.seconds}
    for one in residual.explained:
        found[f"residual.explained.{one.record}"] = one.share
    if isinstance(report, RBFReport):
        for row in report.candidates:
            horizon = "record" if row.horizon is None else row.horizon
            found[f"residual.score.nodes_{row.nodes}.horizon_{horizon}"] = row.score
        return found
    for net in report.networks:
        at = f"{net.output}.{net.depth}x{net.width}.seed_{net.seed}"
        found[f"residual.held_out.{at}"] = net.held_out
    return found


def _trace_metrics(found: Trace) -> dict[str, float | None]:
    """Errors before and after, and each accepted effect's gain, p-value and parameters."""
    numbers: dict[str, float | None] = {
        "trace.seconds": found.seconds,
        "trace.accepted": float(len(found.accepted)),
    }
    for when, rows in (("before", found.before), ("after", found.after)):
        for row in rows:
            where = f"trace.{when}.{row.record}.{row.output}.{row.view}"
            numbers |= _measures(where, row)
    for entry in found.accepted:
        name = f"trace.{entry.name}"
        numbers |= {f"{name}.gain": entry.gain, f"{name}.p_value": entry.p_value}
        numbers |= {f"{name}.{p}": parameter.value for p, parameter in entry.parameters.items()}
    return numbers


def _measures(where: str, row: Metrics) -> dict[str, float]:
    return {f"{where}.{name}": getattr(row, name) for name in ("mse", "rmse", "mae", "r2")}


def cost_history(tree: Path) -> list[float]:
    """The cost after each iteration of the fit."""
    return [cost for cost in fit_of(tree).estimate.history if isfinite(cost)]


def facts(tree: Path, trace: Path | None = None) -> dict[str, str]:
    """What identifies a run beside its config: digests of its data, status of its fit, the verdict of the
    ``trace`` in that folder (None: of the newest)."""
    said = {f"data.{record.name}": record.digest for record in prepared_records(tree)}
    if (tree / ESTIMATE).exists():
        fit = fit_of(tree)
        estimate = fit.estimate
        said |= {"fit.status": estimate.status, "fit.converged": str(estimate.converged).lower()}
        said["fit.quality"] = fit.quality.verdict
    if trace is not None or (tree / TRACE).exists():
        said["trace.verdict"] = trace_of(tree, trace).found.verdict
    return said
