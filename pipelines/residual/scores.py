"""Free runs of the gray box over every record, and what networks make of them: the rows of a grid's table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from hybridid.hybrid import OutputErrorHybrid
from hybridid.records.record import Record
from hybridid.residuals.narx import NARX
from hybridid.simulation.simulate import Diverged
from hybridid.validation import Prediction, free_run, metrics
from pipelines.residual.request import GrayBox

_SCORES = ("mse", "rmse", "r2")


@dataclass(frozen=True, eq=False)
class GrayRun:
    """The gray box over one record, ``fitted`` or not; ``remark`` says why there is no ``prediction``."""

    record: Record
    fitted: bool
    prediction: Prediction | None
    remark: str = ""


def gray_runs(gray: GrayBox, initial_state: str) -> list[GrayRun]:
    """Over the fitted records, then over the others.

    Raises:
        Diverged: if the gray box runs away on a record that it was fitted to.
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


def gray_scores(runs: Sequence[GrayRun], outputs: Sequence[str]) -> list[dict[str, Any]]:
    """MSE, RMSE and R² of the gray box on every record, output by output."""
    return [_row(run, run.prediction, output, run.remark) for output in outputs for run in runs]


def hybrid_scores(gray: GrayBox, runs: Sequence[GrayRun], network: NARX) -> list[dict[str, Any]]:
    """MSE, RMSE and R² of the network's output on every record, with its error added to the gray box'."""
    hybrid = OutputErrorHybrid(gray.model, gray.estimate.values, (network,))
    return [_hybrid_row(hybrid, run, network.output) for run in runs]


def _hybrid_row(hybrid: OutputErrorHybrid, run: GrayRun, output: str) -> dict[str, Any]:
    if run.prediction is None:
        return _row(run, None, output, run.remark)
    try:
        return _row(run, hybrid.corrected(run.prediction, run.record), output)
    except Diverged as error:
        return _row(run, None, output, str(error))


def _row(run: GrayRun, prediction: Prediction | None, output: str, remark: str = "") -> dict[str, Any]:
    about = {"record": run.record.name, "fitted": run.fitted, "provenance": run.record.provenance}
    if prediction is None:
        return {**about, "output": output, **dict.fromkeys(_SCORES), "remark": remark}
    found = next(row for row in metrics(prediction, "hybrid") if row.output == output)
    scores = {name: value for name, value in asdict(found).items() if name in (*_SCORES, "n", "unit")}
    return {**about, "output": output, **scores}
