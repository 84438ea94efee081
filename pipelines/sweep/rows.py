"""What a point's files say of each output: the error on held-out blocks, and those on every record."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isfinite

from hybridid.hybrid.report import NARXReport, RBFReport
from hybridid.validation.metrics import Metrics
from pipelines.shared.fitted import fit_of
from pipelines.shared.hybrids import residual_of
from pipelines.shared.predictions import metric_rows
from pipelines.sweep.point import Point


@dataclass(frozen=True)
class Score:
    """RMSE and R² in free run on one record (None: the model diverged); ``fitted`` if it trained on it."""

    record: str
    fitted: bool
    provenance: str
    rmse: float | None
    r2: float | None


@dataclass(frozen=True, eq=False)
class Row:
    """One output of one point, in the output's unit.

    ``held_out`` is the RMSE on the blocks that no fit has seen, ``without`` the gray box' there; None where
    nothing is held out, or the model diverged. ``size`` is what complexity is counted in: weights, or nodes.
    Of radial basis functions, ``merit`` is what the choice goes by, smaller is better, ``near`` up to what
    it is as good as this one.
    """

    point: Point
    output: str
    unit: str
    scores: tuple[Score, ...]
    size: int = 0
    held_out: float | None = None
    without: float | None = None
    merit: float | None = None
    near: float | None = None

    @property
    def provenance(self) -> str:
        """``measured``, ``simulated``, or both."""
        return " and ".join(sorted({score.provenance for score in self.scores}))


def rows_of(point: Point) -> list[Row]:
    """A row for each output of a finished point."""
    return list({"narx": _narx, "rbf": _rbf}.get(str(point.kind), _gray)(point))


def _narx(point: Point) -> Iterator[Row]:
    report = residual_of(point.tree).report
    assert isinstance(report, NARXReport)
    for one in report.networks:
        scores = tuple(
            Score(row.record, row.fitted, row.provenance, _known(row.rmse), _known(row.r2))
            for row in one.hybrid
        )
        errors = (_known(one.held_out), _known(one.without))
        yield Row(point, one.output, one.unit, scores, one.weights, *errors)


def _rbf(point: Point) -> Iterator[Row]:
    found = residual_of(point.tree)
    assert isinstance(found.report, RBFReport)
    (judged,) = found.report.candidates
    merit = _known(judged.score)
    near = None if merit is None else merit + (_known(judged.standard_error) or 0.0)
    errors = zip(judged.rmse, judged.gray_rmse, _free_runs(point, found.model), strict=True)
    for held_out, without, (output, unit) in errors:
        scores = _scores_of(point, found.model, output, found.records)
        own = (_known(held_out), _known(without), merit, near)
        yield Row(point, output, unit, scores, judged.nodes, *own)


def _gray(point: Point) -> Iterator[Row]:
    fit = fit_of(point.tree)
    for output, unit in _free_runs(point, fit.model):
        yield Row(point, output, unit, _scores_of(point, fit.model, output, fit.records))


def _free_runs(point: Point, model: str) -> list[tuple[str, str]]:
    """Outputs and their units."""
    rows = [row for row in metric_rows(point.tree) if row.model == model and row.view != "loop"]
    return list(dict.fromkeys((row.output, row.unit) for row in rows))


def _scores_of(point: Point, model: str, output: str, fitted: Sequence[str]) -> tuple[Score, ...]:
    return tuple(
        Score(_label(row), row.record in fitted, row.provenance, _known(row.rmse), _known(row.r2))
        for row in metric_rows(point.tree)
        if (row.model, row.output) == (model, output) and row.view != "loop"
    )


def _label(row: Metrics) -> str:
    """The record, and the horizon unless the row is of a free run."""
    return row.record if row.horizon is None else f"{row.record}, horizon {row.horizon:g} s"


def _known(value: float) -> float | None:
    return value if isfinite(value) else None
