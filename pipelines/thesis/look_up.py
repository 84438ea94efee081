"""Finds our value for each number of the thesis in the run trees, or the reason why there is none."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from hybridid.estimators.estimate import EstimatedParameter
from hybridid.hybrid.report import NARXReport, NetworkScore, RecordScore
from hybridid.validation.metrics import Metrics
from pipelines.shared.fitted import Fit, fit_of
from pipelines.shared.hybrids import residual_of
from pipelines.shared.predictions import metric_rows
from pipelines.shared.prepared import prepared_records
from pipelines.thesis.reference import EveryEstimate, NetworkOf, ParameterOf, ScoreOf


@dataclass(frozen=True)
class Failed:
    """An experiment without results: the reason in one line, and the traceback."""

    reason: str
    traceback: str = ""


@dataclass(frozen=True)
class Networks:
    """The networks of a sweep, used in place of a run tree: scores of the networks and of the gray box as in
    ``residual.json``, and the role of each record."""

    rows: Sequence[NetworkScore]
    gray: Sequence[RecordScore]
    roles: Mapping[str, str]


Outcomes = Mapping[str, Path | Failed | Networks]
"""The outcome of each requested experiment: its run tree, its sweep, or why it failed."""


class Missing(Exception):
    """A number that does not exist; the page shows the message in its place."""


class NotRun(Missing):
    """The experiment was not requested."""


@dataclass(frozen=True)
class FoundEstimate:
    """Our estimate, its standard error (nan: it has none), and remarks such as "at its bound"."""

    name: str
    value: float
    std: float
    unit: str
    provenance: str
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class FoundScore:
    """Our errors and R² of one model on one record; ``chosen`` if our rule chose that network."""

    rmse: float
    mse: float
    r2: float
    provenance: str
    chosen: bool = False


def tree_of(experiment: str, outcomes: Outcomes) -> Path:
    """The run tree of an experiment.

    Raises:
        Missing: if it failed; ``NotRun`` if it was not requested.
    """
    if experiment not in outcomes:
        raise NotRun("not run")
    outcome = outcomes[experiment]
    if isinstance(outcome, Failed):
        raise Missing(f"failed: {outcome.reason}")
    if isinstance(outcome, Networks):
        raise Missing("a sweep has no such result")
    return outcome


def estimate(where: ParameterOf, outcomes: Outcomes) -> FoundEstimate:
    """Our estimate of one parameter.

    Raises:
        Missing: if the experiment did not estimate it.
    """
    fit = fit_of(tree_of(where.experiment, outcomes))
    for parameter in fit.estimate.parameters:
        if parameter.name == where.name:
            return _estimate(parameter, fit)
    raise Missing("not estimated")


def estimates(where: EveryEstimate, outcomes: Outcomes) -> Iterator[FoundEstimate]:
    """Our estimates of all parameters of an experiment.

    Raises:
        Missing: if the experiment has no results.
    """
    fit = fit_of(tree_of(where.experiment, outcomes))
    yield from (_estimate(parameter, fit) for parameter in fit.estimate.parameters)


def score(where: ScoreOf | NetworkOf, outcomes: Outcomes) -> FoundScore:
    """Our score.

    Raises:
        Missing: if there is no such record or model, or the model diverged on it.
    """
    swept = outcomes.get(where.experiment)
    if isinstance(swept, Networks):
        names = {name for name, role in swept.roles.items() if role == where.role}
        if isinstance(where, NetworkOf):
            return _network(where, swept.rows, names)
        return _on(names, [row for row in swept.gray if row.output == where.output])
    tree = tree_of(where.experiment, outcomes)
    names = {record.name for record in prepared_records(tree) if record.role == where.role}
    if not names:
        raise Missing("no such record")
    if isinstance(where, NetworkOf):
        report = residual_of(tree).report
        return _network(where, report.networks if isinstance(report, NARXReport) else (), names)
    return _model(where, tree, names)


def _estimate(parameter: EstimatedParameter, fit: Fit) -> FoundEstimate:
    remarks = [
        word
        for word, applies in (
            ("at its bound", parameter.at_bound),
            ("not identifiable", not parameter.identifiable),
            ("fit not converged", not fit.estimate.converged),
        )
        if applies
    ]
    p = parameter
    return FoundEstimate(p.name, p.value, p.std, p.unit, fit.provenance, tuple(remarks))


def _model(where: ScoreOf, tree: Path, names: set[str]) -> FoundScore:
    gray = fit_of(tree).model
    for row in metric_rows(tree):
        of = "gray box" if row.model == gray else "hybrid"
        if row.record in names and (of, row.output, row.view) == (where.of, where.output, where.view):
            return _score(row)
    raise Missing(f"no {where.of} here")


def _network(where: NetworkOf, networks: Sequence[NetworkScore], names: set[str]) -> FoundScore:
    """The score of the network of one size; of several seeds, that with the lowest held-out error."""
    wanted = (where.output, where.depth, where.width)
    rows = [row for row in networks if (row.output, row.depth, row.width) == wanted]
    if not rows:
        raise Missing("no such network")
    best = min(rows, key=lambda row: row.held_out if isfinite(row.held_out) else float("inf"))
    return _on(names, best.hybrid, any(row.chosen for row in rows))


def _on(names: set[str], rows: Sequence[RecordScore], chosen: bool = False) -> FoundScore:
    for row in rows:
        if row.record in names:
            return _score(row, chosen)
    raise Missing("not simulated on this record")


def _score(row: Metrics | RecordScore, chosen: bool = False) -> FoundScore:
    if not isfinite(row.rmse):
        raise Missing(f"diverged: {row.remark or 'no finite prediction'}")
    return FoundScore(row.rmse, row.rmse**2, row.r2, row.provenance, chosen)
