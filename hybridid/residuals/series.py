"""``ErrorSeries``: the error of a gray box in one output, with the signals that may explain it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.records.record import Record, RecordError
from hybridid.validation.predict import Prediction

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The signals that a network on one output uses beside past errors.

    ``inputs`` (n, n_u) and ``gray`` (n,), the gray box' output, every ``dt`` s. ``breaks`` are the
    samples at which a simulation starts, including the first.
    """

    output: str
    unit: str
    dt: float
    inputs: Array
    input_names: tuple[str, ...]
    gray: Array
    breaks: tuple[int, ...]

    @property
    def pieces(self) -> list[slice]:
        """The stretches of samples between two breaks."""
        ends = (*self.breaks[1:], len(self.gray))
        return [slice(a, b) for a, b in zip(self.breaks, ends, strict=True)]


@dataclass(frozen=True, eq=False)
class ErrorSeries:
    """``error = y - y_gray`` (n,) of one output of one record, nan where it was not measured, and its
    surroundings."""

    record: str
    provenance: str
    error: Array
    seen: Surroundings


def surroundings(prediction: Prediction, record: Record, output: str) -> Surroundings:
    """The signals for a network on ``output`` along a gray box' prediction of ``record``.

    Raises:
        RecordError: if the record is masked.
    """
    if record.masked:
        first, end, _ = record.masked[0]
        raise RecordError(
            f"record {record.name} is masked, first from t = {record.time[first]:g} s to "
            f"{record.time[end - 1]:g} s: residual=narx runs through whole records; crop the record to "
            "a part between its masks (preprocess.steps=[{step: crop, ...}]), or use residual=rbf"
        )
    column = prediction.output_names.index(output)
    running = [k for k, channel in enumerate(record.input_channels) if not channel.constant]
    return Surroundings(
        output=output,
        unit=prediction.output_units[column],
        dt=record.dt,
        inputs=record.inputs[: len(prediction.time), running],
        input_names=tuple(record.input_channels[k].name for k in running),
        gray=prediction.predicted[:, column],
        breaks=prediction.breaks,
    )


def error_series(prediction: Prediction, record: Record, output: str) -> ErrorSeries:
    """The error of a gray box' prediction of ``record`` in ``output``."""
    column = prediction.output_names.index(output)
    seen = surroundings(prediction, record, output)
    return ErrorSeries(record.name, record.provenance, prediction.error[:, column], seen)
