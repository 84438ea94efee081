"""A gray box with its records, its free runs over them, and the scores of both with and without a network."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hybridid.estimators.estimate import Estimate
from hybridid.hybrid.output_error import OutputErrorHybrid
from hybridid.hybrid.report import RecordScore
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.residuals.narx import NARX
from hybridid.residuals.series import ErrorSeries, error_series
from hybridid.simulation.simulate import Diverged
from hybridid.validation import Prediction, diverged, free_run, metrics

Errors = Mapping[str, tuple[ErrorSeries, ...]]
"""By output, one for each record."""


@dataclass(frozen=True, eq=False)
class GrayBox:
    """A fitted model, and the records that its network is fitted to.

    Networks are scored on ``unseen`` records after every choice is made; these never take part in one.
    """

    model: Model
    estimate: Estimate
    records: tuple[Record, ...]
    unseen: tuple[Record, ...] = ()


@dataclass(frozen=True, eq=False)
class GrayRun:
    """The gray box over one record, ``fitted`` or not; ``remark`` says why there is no ``prediction``."""

    record: Record
    fitted: bool
    prediction: Prediction | None
    remark: str = ""


def gray_runs(gray: GrayBox, initial_state: str = "estimated") -> list[GrayRun]:
    """Free runs over the fitted records, then over the others.

    Raises:
        Diverged: if the gray box diverges on a record that it was fitted to.
    """
    integrator = gray.estimate.settings.integrator
    made = []
    for record, fitted in [*((r, True) for r in gray.records), *((r, False) for r in gray.unseen)]:
        try:
            prediction = free_run(gray.model, gray.estimate.values, record, initial_state, integrator)
            made.append(GrayRun(record, fitted, prediction))
        except Diverged as error:
            if fitted:
                raise
            made.append(GrayRun(record, fitted, None, str(error)))
    return made


def errors_of(runs: Sequence[GrayRun]) -> Errors:
    """What the gray box leaves of every output of the fitted records. Networks of one stack that get the very
    same errors share their windows."""
    fitted = [(run.prediction, run.record) for run in runs if run.fitted and run.prediction]
    return {
        output: tuple(error_series(prediction, record, output) for prediction, record in fitted)
        for output in fitted[0][0].output_names
    }


def gray_scores(gray: GrayBox, runs: Sequence[GrayRun], outputs: Sequence[str]) -> tuple[RecordScore, ...]:
    """MSE, RMSE and R² of the gray box on every record, output by output."""
    return tuple(
        _score(gray.model, run, run.prediction, output, run.remark) for output in outputs for run in runs
    )


def hybrid_scores(gray: GrayBox, runs: Sequence[GrayRun], network: NARX) -> tuple[RecordScore, ...]:
    """MSE, RMSE and R² of the network's output on every record, with its error added to the gray box'."""
    hybrid = OutputErrorHybrid(gray.model, gray.estimate.values, (network,))
    return tuple(_hybrid_score(hybrid, run, network.output) for run in runs)


def _hybrid_score(hybrid: OutputErrorHybrid, run: GrayRun, output: str) -> RecordScore:
    if run.prediction is None:
        return _score(hybrid.model, run, None, output, run.remark)
    try:
        return _score(hybrid.model, run, hybrid.corrected(run.prediction, run.record), output)
    except Diverged as error:
        return _score(hybrid.model, run, None, output, str(error))


def _score(
    model: Model, run: GrayRun, prediction: Prediction | None, output: str, remark: str = ""
) -> RecordScore:
    rows = diverged(run.record, model.outputs, "", remark) if prediction is None else metrics(prediction, "")
    row = next(row for row in rows if row.output == output)
    about = (run.record.name, run.fitted, row.provenance, output)
    return RecordScore(*about, row.mse, row.rmse, row.r2, row.n, row.unit, remark)
