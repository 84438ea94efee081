"""Error measures of a prediction (thesis Eqs. 3-15 to 3-17)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.validation.predict import Prediction

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Metrics:
    """Error measures of one output of one record in one view, in SI units.

    ``mse = mean (y - y_hat)^2``, ``rmse = sqrt(mse)``, ``r2 = 1 - sum (y - y_hat)^2 /
    sum (y - mean y)^2``, ``fit_percent = 100 (1 - ||y - y_hat|| / ||y - mean y||)``.
    ``provenance`` is "measured" or "simulated".
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


def metrics(prediction: Prediction, model_name: str) -> list[Metrics]:
    """The error measures of each output of the prediction."""
    return [
        _row(prediction, model_name, k, name, unit)
        for k, (name, unit) in enumerate(zip(prediction.output_names, prediction.output_units, strict=True))
    ]


def _row(prediction: Prediction, model_name: str, column: int, output: str, unit: str) -> Metrics:
    y = prediction.measured[:, column]
    squares = float(np.sum((y - prediction.predicted[:, column]) ** 2))
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
    )
