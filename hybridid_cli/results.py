"""Results as a person reads them: tables of records, estimates and scores, and where the files went."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rich.console import RenderableType
from rich.text import Text

from hybridid.estimators.estimate import EstimatedParameter
from hybridid.quantities import fixed, mean_square, number, quantity, r_squared
from hybridid.validation.metrics import Metrics
from hybridid_cli.residual_results import residual_results
from hybridid_cli.tables import rendered, table
from hybridid_cli.trace_results import trace_results
from pipelines.shared.fitted import fit_of
from pipelines.shared.predictions import metric_rows
from pipelines.shared.prepared import prepared_records
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
    for one in prepared_records(tree):
        rate = f"{1 / one.dt:.6g} Hz"
        made.add_row(one.name, one.role, str(one.n), rate, _provenance(one.provenance), one.source)
        notes += [Text(f"WARNING: record {one.name}: {line}", style="yellow") for line in one.warnings]
    return [made, *notes]


def _estimates(tree: Path) -> list[RenderableType]:
    found = fit_of(tree)
    estimate = found.estimate
    fitted = ", ".join(found.records)
    columns = [
        ("parameter", ""),
        ("value", "right"),
        ("std", "right"),
        ("unit", ""),
        ("bounds", ""),
        ("", ""),
    ]
    made = table(f"Estimates from {fitted} ({found.provenance})", columns)
    for p in estimate.parameters:
        bounds = f"[{number(p.lower, 6, '−∞')}, {number(p.upper, 6, '∞')}]"
        made.add_row(p.name, number(p.value, 6), number(p.std, 2), p.unit, bounds, _flags(p))
    seconds = estimate.seconds
    line = (
        f"{estimate.status} after {estimate.iterations} iterations on {found.provenance} data, "
        f"cost {number(estimate.cost, 6)}, build {seconds['build']:.2f} s, solve {seconds['solve']:.2f} s"
    )
    lines: list[RenderableType] = [made, Text(line)]
    if not estimate.converged:
        lines.append(
            Text("NOT CONVERGED: these numbers are where the solver stopped, no optimum", style="bold red")
        )
    return lines + [Text(f"WARNING: {warning}", style="yellow") for warning in estimate.warnings]


def _flags(parameter: EstimatedParameter) -> Text:
    flags = [
        word
        for word, on in (
            ("AT BOUND", parameter.at_bound),
            ("NOT IDENTIFIABLE", not parameter.identifiable),
        )
        if on
    ]
    return Text(", ".join(flags), style="bold red")


def _scores(tree: Path) -> list[RenderableType]:
    rows = metric_rows(tree)
    several = len({row.model for row in rows}) > 1
    names = [(name, "") for name in (*(("model",) if several else ()), "record", "output", "view")]
    scores = [(name, "right") for name in ("RMSE", "MSE", "R²", "fit %", "n")]
    made = table("Scores", [*names, *scores, ("data", "")])
    for row in rows:
        made.add_row(
            *((row.model,) if several else ()),
            row.record,
            row.output,
            _view(row),
            quantity(row.rmse, row.unit),
            mean_square(row.mse, row.unit),
            r_squared(row.r2),
            fixed(row.fit_percent, 2, missing=""),
            str(row.n),
            _provenance(row.provenance),
        )
    return [made]


def _view(row: Metrics) -> str:
    return "free run" if row.horizon is None else f"horizon {row.horizon:g} s"


def _figures(tree: Path) -> list[RenderableType]:
    files = sorted(p.relative_to(tree) for p in (tree / "plot").iterdir() if p.suffix == ".png") or sorted(
        p.relative_to(tree) for p in (tree / "plot").iterdir() if p.suffix != ".json"
    )
    return [Text("Figures", style="bold"), *(Text(f"  {path}") for path in files), Text("")]


def _provenance(word: str) -> Text:
    return Text(word, style="bold magenta" if word == "simulated" else "")


_SECTIONS: dict[str, Callable[[Path], list[RenderableType]]] = {
    "preprocess": _records,
    "fit": _estimates,
    "residual": residual_results,
    "validate": _scores,
    "plot": _figures,
    "trace": trace_results,
}
