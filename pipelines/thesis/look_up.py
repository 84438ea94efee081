"""Finds our number beside each of the thesis' in the run trees, or says why there is none."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipelines.shared.findings import estimate_of, metric_rows, prepared_records, residual_of
from pipelines.thesis.reference import EveryEstimate, NetworkOf, ParameterOf, ScoreOf


@dataclass(frozen=True)
class Failed:
    """An experiment without results: why, in one line, and where in the code."""

    reason: str
    traceback: str = ""


@dataclass(frozen=True)
class Networks:
    """The networks of a sweep in place of a run tree: rows as in ``residual.json``, of them and of the gray
    box, and the role of each record."""

    rows: Sequence[Mapping[str, Any]]
    gray: Sequence[Mapping[str, Any]]
    roles: Mapping[str, str]


Outcomes = Mapping[str, Path | Failed | Networks]
"""Each experiment that was asked for: its run tree or its sweep, or why there is none."""


class Missing(Exception):
    """A number that is not there; the message stands in its place on the page."""


class NotRun(Missing):
    """Nobody asked for the experiment."""


@dataclass(frozen=True)
class FoundEstimate:
    """Our estimate, its standard error where it has one, what a reader must know of it."""

    name: str
    value: float | None
    std: float | None
    unit: str
    provenance: str
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class FoundScore:
    """Our errors and R² of one model on one record; ``chosen`` if our rule took that network."""

    rmse: float
    mse: float
    r2: float
    provenance: str
    chosen: bool = False


def tree_of(experiment: str, outcomes: Outcomes) -> Path:
    """The run tree of an experiment.

    Raises:
        Missing: if it failed; ``NotRun`` if it was not asked for.
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
    data = estimate_of(tree_of(where.experiment, outcomes))
    if where.name not in data["parameters"]:
        raise Missing("not estimated")
    return _estimate(where.name, data)


def estimates(where: EveryEstimate, outcomes: Outcomes) -> Iterator[FoundEstimate]:
    """Our estimates of all parameters of an experiment.

    Raises:
        Missing: if the experiment has no results.
    """
    data = estimate_of(tree_of(where.experiment, outcomes))
    yield from (_estimate(name, data) for name in data["parameters"])


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
        return _on(names, [row for row in swept.gray if row["output"] == where.output])
    tree = tree_of(where.experiment, outcomes)
    names = {record.name for record in prepared_records(tree) if record.role == where.role}
    if not names:
        raise Missing("no such record")
    if isinstance(where, NetworkOf):
        return _network(where, residual_of(tree)["networks"], names)
    return _model(where, tree, names)


def _estimate(name: str, data: Mapping[str, Any]) -> FoundEstimate:
    row = data["parameters"][name]
    remarks = [
        word
        for word, applies in (
            ("at its bound", row["at_bound"]),
            ("not identifiable", not row["identifiable"]),
            ("fit not converged", not data["converged"]),
        )
        if applies
    ]
    return FoundEstimate(name, row["value"], row["std"], row["unit"], str(data["provenance"]), tuple(remarks))


def _model(where: ScoreOf, tree: Path, names: set[str]) -> FoundScore:
    gray = estimate_of(tree)["model"]
    for row in metric_rows(tree):
        of = "gray box" if row["model"] == gray else "hybrid"
        if row["record"] in names and (of, row["output"], row["view"]) == (
            where.of,
            where.output,
            where.view,
        ):
            return _score(row)
    raise Missing(f"no {where.of} here")


def _network(where: NetworkOf, networks: Sequence[Mapping[str, Any]], names: set[str]) -> FoundScore:
    """Of the seeds of one size, the one whose held-out error was lowest."""
    wanted = (where.output, where.depth, where.width)
    rows = [row for row in networks if (row["output"], row["depth"], row["width"]) == wanted]
    if not rows:
        raise Missing("no such network")
    best = min(rows, key=lambda row: float("inf") if row["held_out"] is None else row["held_out"])
    return _on(names, best["hybrid"], any(row["chosen"] for row in rows))


def _on(names: set[str], rows: Sequence[Mapping[str, Any]], chosen: bool = False) -> FoundScore:
    for row in rows:
        if row["record"] in names:
            return _score(row, chosen)
    raise Missing("not simulated on this record")


def _score(row: Mapping[str, Any], chosen: bool = False) -> FoundScore:
    if row["rmse"] is None:
        raise Missing(f"diverged: {row.get('remark') or 'no finite prediction'}")
    rmse = float(row["rmse"])
    return FoundScore(rmse, rmse**2, float(row["r2"]), str(row["provenance"]), chosen)
