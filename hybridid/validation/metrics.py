"""Error measures of a prediction (thesis Eqs. 3-15 to 3-17)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.declarations import Signal
from hybridid.records.record import Record
from hybridid.validation.predict import Prediction

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Metrics:
    """Error measures of one output of one record in one view, in SI units. In the view ``loop`` a command of
    the controller counts as an output.

    ``mse = mean (y - y_hat)^2``, ``rmse = sqrt(mse)``, ``mae = mean |y - y_hat|``,
    ``r2 = 1 - sum (y - y_hat)^2 / sum (y - mean y)^2``,
    ``fit_percent = 100 (1 - ||y - y_hat|| / ||y - mean y||)``.
    ``provenance`` is "measured" or "simulated"; ``horizon`` is in s, None in free run and in the loop. The
    scores are nan where the model diverged; then ``remark`` says so.
    """

    model: str
    record: str
    output: str
    view: str
    mse: float
    rmse: float
    r2: float
    fit_percent: float
    n: int
    unit: str
    provenance: str
    horizon: float | None = None
    remark: str = ""
    mae: float = np.nan


def metrics(prediction: Prediction, model_name: str, horizon: float | None = None) -> list[Metrics]:
    """The error measures of each output of the prediction, over a ``horizon`` in s or in free run."""
    return [
        replace(_row(prediction, model_name, k, name, unit), horizon=horizon)
        for k, (name, unit) in enumerate(zip(prediction.output_names, prediction.output_units, strict=True))
    ]


def diverged(
    record: Record,
    outputs: Sequence[Signal],
    model_name: str,
    remark: str,
    horizon: float | None = None,
    view: str | None = None,
) -> list[Metrics]:
    """One row without scores for each of ``outputs``; ``remark`` says why the model cannot be simulated.

    Without a ``view`` it is the free run, or over horizons where ``horizon`` is given.
    """
    nan = float("nan")
    return [
        Metrics(
            model=model_name,
            record=record.name,
            output=output.name,
            view=view or ("free_run" if horizon is None else "horizon"),
            mse=nan,
            rmse=nan,
            r2=nan,
            fit_percent=nan,
            n=int(record.counts.sum()),
            unit=output.unit,
            provenance=record.provenance,
            horizon=horizon,
            remark=remark,
        )
        for output in outputs
    ]


def _row(prediction: Prediction, model_name: str, column: int, output: str, unit: str) -> Metrics:
    kept, _ = prediction.samples_of(column)
    y = prediction.measured[kept, column]
    error = y - prediction.predicted[kept, column]
    squares = float(np.sum(error**2))
    spread = float(np.sum((y - y.mean()) ** 2))
    ratio = squares / spread if spread > 0 else (np.inf if squares > 0 else 0.0)
    mse = squares / len(y)
    return Metrics(
        model=model_name,
        record=prediction.record,
        output=output,
        view=prediction.view,
        mse=mse,
        rmse=float(np.sqrt(mse)),
        r2=1.0 - ratio,
        fit_percent=100.0 * (1.0 - float(np.sqrt(ratio))),
        n=len(y),
        unit=unit,
        provenance=prediction.provenance,
        mae=float(np.mean(np.abs(error))),
    )
