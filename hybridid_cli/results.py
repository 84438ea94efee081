"""Results as a person reads them: tables of records, estimates and scores, and where the files went."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

from rich.console import RenderableType
from rich.text import Text

from hybridid.estimators.estimate import Estimate, EstimatedParameter
from hybridid.estimators.words import differ_together, differs
from hybridid.quantities import NONE, fixed, mean_square, number, quantity, r_squared
from hybridid.validation.in_loop import Agreement
from hybridid_cli.tables import provenance, rendered, table, view, warnings
from pipelines.shared.fitted import Fit, fit_of
from pipelines.shared.predictions import agreements_in, metric_rows
from pipelines.shared.prepared import prepared_records
from pipelines.shared.remarks import together
from pipelines.shared.stage import Outcome


def summary(outcome: Outcome, command: str) -> str:
    """What ``command`` found, as text: one table a stage, then the tree."""
    shown = outcome.stages if command == "run" else (command,)
    parts = [part for name in shown for part in _shown(outcome, name)]
    return rendered([*parts, Text(f"files: {outcome.tree}")])


def _shown(outcome: Outcome, stage: str) -> list[RenderableType]:
    if stage == "trace":  # imports of its own, which a fit need not wait for
        from hybridid_cli.trace_results import trace_results

        return trace_results(outcome.tree, outcome.folders[stage])
    if stage == "residual":
        from hybridid_cli.residual_results import residual_results

        return residual_results(outcome.tree)
    return _SECTIONS[stage](outcome.tree)


def _records(tree: Path) -> list[RenderableType]:
    made = table("Records", ("record", "role", "samples", "rate", "data", "from"), words=(0, 1, 4, 5))
    records = prepared_records(tree)
    for one in records:
        rate, samples = f"{1 / one.dt:.6g} Hz", str(one.n)
        if one.masked:
            samples = f"{one.n - one.masked} of {one.n}"
        made.add_row(one.name, one.role, samples, rate, provenance(one.provenance), one.source)
    return [made, *warnings(together({one.name: one.warnings for one in records}))]


def _estimates(tree: Path) -> list[RenderableType]:
    found = fit_of(tree)
    estimate = found.estimate
    fitted = ", ".join(found.records)
    columns = ("parameter", "value", "std", "unit", "bounds", "")
    made = table(f"Estimates from {fitted} ({found.provenance})", columns, words=(0, 3, 4, 5))
    for p in estimate.parameters:
        bounds = f"[{number(p.lower, 6, '−∞')}, {number(p.upper, 6, '∞')}]"
        made.add_row(p.name, number(p.value, 6), number(p.std, 2, NONE), p.unit, bounds, _flags(p))
    seconds = estimate.seconds
    line = (
        f"{_ended(estimate)} on {found.provenance} data, "
        f"cost {number(estimate.cost, 6)}, build {seconds['build']:.2f} s, solve {seconds['solve']:.2f} s"
    )
    said = {finding.said for finding in found.quality.findings}
    rest = [warning for warning in estimate.warnings if warning not in said]
    differ = [Text(differs(one)) for one in estimate.differences]
    if estimate.together is not None and not math.isnan(estimate.together.p_value):
        differ.append(Text(differ_together(estimate.together)))
    return [*_quality(found), made, *differ, Text(line), *warnings(rest)]


def _ended(estimate: Estimate) -> str:
    """How the fit ended and after how many iterations, which the status may say itself."""
    status = estimate.status
    return status if "iterations" in status else f"{status} after {estimate.iterations} iterations"


def _quality(found: Fit) -> list[RenderableType]:
    """The verdict on a fit and what it rests on, before any of its numbers."""
    quality = found.quality
    style = "bold" if quality.trusted else "bold red"
    mark = "yellow" if quality.trusted else "bold red"
    columns = ("output", "view", "RMSE", "doing nothing", "R²", "sensor's noise", "simulation's error")
    made = table(f"What the model leaves ({found.provenance})", columns, words=(0, 1))
    left = {one.output: one for one in found.estimate.left}
    for v in quality.views:
        floor = left[v.output]
        made.add_row(
            v.output,
            view(v.horizon),
            quantity(v.rmse, v.unit),
            quantity(v.nothing, v.unit, 3),
            r_squared(v.r2),
            quantity(floor.noise, v.unit, 2, NONE),
            quantity(floor.simulation, v.unit, 2),
        )
    return [
        Text(f"Fit quality ({found.provenance}): {quality.said}", style=style),
        *(Text(f"  {finding.said}", style=mark) for finding in quality.findings),
        *(Text(f"  advice: {one.said}", style="cyan") for one in quality.advice),
        made,
    ]


def _flags(parameter: EstimatedParameter) -> Text:
    flags = {"AT BOUND": parameter.at_bound, "NOT IDENTIFIABLE": not parameter.identifiable}
    return Text(", ".join(word for word, raised in flags.items() if raised), style="bold red")


def _scores(tree: Path) -> list[RenderableType]:
    rows = metric_rows(tree)
    several = len({row.model for row in rows}) > 1
    names = (*(("model",) if several else ()), "record", "output", "view")
    columns = (*names, "RMSE", "MAE", "MSE", "R²", "fit %", "n", "data")
    made = table("Scores", columns, words=(*range(len(names)), len(columns) - 1))
    for row in rows:
        made.add_row(
            *((row.model,) if several else ()),
            row.record,
            row.output,
            view(row.horizon, row.view),
            quantity(row.rmse, row.unit),
            quantity(row.mae, row.unit),
            mean_square(row.mse, row.unit),
            r_squared(row.r2),
            fixed(row.fit_percent, 2, missing=""),
            str(row.n),
            provenance(row.provenance),
        )
    return [made, *_laws(tree)]


def _laws(tree: Path) -> list[RenderableType]:
    """Whether the control law is the one that ran the machine, before a score in the loop is believed."""
    return [
        Text(
            _law(one)
            if math.isfinite(one.rms)
            else f"in the loop ({one.provenance}): not simulated: {one.remark}"
        )
        for one in agreements_in(tree)
    ]


def _law(one: Agreement) -> str:
    return (
        f"in the loop ({one.provenance}): with the recorded outputs of {one.record}, the law of "
        f"{one.controller} gives the recorded {one.command} within {quantity(one.rms, one.unit, 3)} RMS "
        f"({one.said})" + ("" if one.agrees else "; too far apart: not simulated")
    )


def _figures(tree: Path) -> list[RenderableType]:
    files = sorted(p.relative_to(tree) for p in (tree / "plot").iterdir() if p.suffix == ".png") or sorted(
        p.relative_to(tree) for p in (tree / "plot").iterdir() if p.suffix != ".json"
    )
    return [Text("Figures", style="bold"), *(Text(f"  {path}") for path in files), Text("")]


_SECTIONS: dict[str, Callable[[Path], list[RenderableType]]] = {
    "preprocess": _records,
    "fit": _estimates,
    "validate": _scores,
    "plot": _figures,
}
