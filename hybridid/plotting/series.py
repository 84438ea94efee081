"""What the figures show: which quantity of which record, and what a model answered."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybridid.records.record import Record

Array = NDArray[np.float64]


class PlotError(ValueError):
    """Something that cannot be drawn: the message says what, and what is allowed."""


@dataclass(frozen=True)
class Subject:
    """The quantity that a figure shows, e.g. the output ``position`` in ``m`` of one record."""

    record: str
    quantity: str
    unit: str
    provenance: str = "measured"

    @classmethod
    def of(cls, record: Record, output: str | None = None) -> Subject:
        """The output called ``output`` of ``record``, its first if ``None``.

        Raises:
            PlotError: if the record has no such output.
        """
        channels = {channel.name: channel for channel in record.output_channels}
        name = next(iter(channels)) if output is None else output
        if name not in channels:
            near = difflib.get_close_matches(name, channels, n=1, cutoff=0.0)[0]
            raise PlotError(
                f"record {record.name}: no output {name!r} to plot; nearest {near!r}, "
                f"allowed: {', '.join(channels)}"
            )
        return cls(record.name, name, channels[name].unit, record.provenance)

    @property
    def title(self) -> str:
        return f"{self.record} · {self.quantity.replace('_', ' ')}"


@dataclass(frozen=True)
class Response:
    """One model's response beside the measured output, both (n,), in the subject's unit.

    ``starts`` are the times at which a prediction begins anew from its own initial state
    (the horizons' boundaries); empty for a free run. ``view`` is how it was made, in words:
    ``free run``, ``horizons of 1 s``.
    """

    model: str
    time: Array
    measured: Array
    predicted: Array
    view: str = "free run"
    starts: Array = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        if not len(self.time) == len(self.measured) == len(self.predicted):
            raise PlotError(
                f"response of {self.model}: time, measured and predicted have {len(self.time)}, "
                f"{len(self.measured)} and {len(self.predicted)} samples; they must be as long"
            )

    @property
    def error(self) -> Array:
        """Measured minus predicted, (n,)."""
        return self.measured - self.predicted

    @property
    def rmse(self) -> float:
        """Root mean square error, in the subject's unit."""
        return float(np.sqrt(np.mean(self.error**2)))


def some_responses(subject: Subject, responses: Sequence[Response]) -> Sequence[Response]:
    """``responses``, of which there is at least one.

    Raises:
        PlotError: if there is none.
    """
    if not responses:
        where = f"{subject.record}, {subject.quantity}"
        raise PlotError(f"{where}: no model's response to plot; give at least one")
    return responses
