"""``Response``: a model's response and the recorded signal."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybridid.validation.predict import Prediction, holes_of

Array = NDArray[np.float64]


WHOLE: Mapping[str, str] = {"free_run": "free run", "loop": "in the loop"}
"""Views of a whole record in one go, in words."""


class PlotError(ValueError):
    """Raised for something that cannot be drawn: the message says what, and what is allowed."""


@dataclass(frozen=True)
class Response:
    """One model's response to one record, one output of it, all (n,) in ``unit``.

    ``view`` names the kind of simulation: ``free run``, ``horizons of 1 s``, ``in the loop``. ``starts`` are
    the times at which a horizon begins from its own initial state; a free run has none. ``holes`` (h, 2) are
    the times before and after each masked stretch.

    Raises:
        PlotError: if the lengths differ.
    """

    model: str
    record: str
    output: str
    unit: str
    time: Array
    measured: Array
    predicted: Array
    view: str = "free run"
    starts: Array = field(default_factory=lambda: np.empty(0))
    provenance: str = "measured"
    holes: Array = field(default_factory=lambda: np.empty((0, 2)))

    def __post_init__(self) -> None:
        if not len(self.time) == len(self.measured) == len(self.predicted):
            raise PlotError(
                f"response of {self.model} to {self.record}: time, measured and predicted have "
                f"{len(self.time)}, {len(self.measured)} and {len(self.predicted)} samples; "
                "they must have as many"
            )

    @classmethod
    def of(cls, model: str, prediction: Prediction, output: str | None = None) -> Response:
        """The output called ``output`` (the first if ``None``) of a prediction by ``model``.

        Raises:
            PlotError: if the prediction has no such output.
        """
        names = prediction.output_names
        name = names[0] if output is None else output
        if name not in names:
            near = difflib.get_close_matches(name, names, n=1, cutoff=0.0)[0]
            raise PlotError(
                f"record {prediction.record}: no output {name!r} to plot; nearest {near!r}, "
                f"allowed: {', '.join(names)}"
            )
        column = names.index(name)
        starts = _starts(prediction)
        kept, rows = prediction.samples_of(column)
        time = prediction.time[kept]
        return cls(
            model=model,
            record=prediction.record,
            output=name,
            unit=prediction.output_units[column],
            time=time,
            measured=prediction.measured[kept, column],
            predicted=prediction.predicted[kept, column],
            view=_view(prediction, starts),
            starts=starts,
            provenance=prediction.provenance,
            holes=np.empty((0, 2)) if rows is None else holes_of(time, rows),
        )

    @property
    def breaks(self) -> Array:
        """Times before which a line is interrupted: where a horizon begins, and after each masked stretch."""
        return np.union1d(self.starts, self.holes[:, 1]) if len(self.holes) else self.starts

    @property
    def error(self) -> Array:
        """Measured minus predicted, (n,)."""
        return self.measured - self.predicted

    @property
    def rmse(self) -> float:
        """Root mean square error, in ``unit``."""
        return float(np.sqrt(np.mean(self.error**2)))

    @property
    def title(self) -> str:
        """Record and output, for the first line of a figure."""
        return f"{self.record} · {self.output.replace('_', ' ')}"


def _starts(prediction: Prediction) -> Array:
    """The times of ``prediction.breaks`` (samples of the record); none for a free run."""
    if prediction.view in WHOLE:
        return np.empty(0)
    return prediction.time[prediction.starts]


def _view(prediction: Prediction, starts: Array) -> str:
    if prediction.view in WHOLE:
        return WHOLE[prediction.view]
    stop = starts[1] if len(starts) > 1 else prediction.time[-1]
    usual = float(np.median(np.diff(starts))) if prediction.rows is not None and len(starts) > 1 else 0.0
    return f"horizons of {usual or stop - starts[0]:.3g} s"


def one_output(responses: Sequence[Response], one_record: bool = True) -> Response:
    """The longest of ``responses``, which must all show one output (of one record).

    Raises:
        PlotError: if there is no response, or they show different things.
    """
    if not responses:
        raise PlotError("no model's response to plot; give at least one")
    longest = max(responses, key=lambda response: len(response.time))
    for other in responses:
        if (other.output, other.unit) != (longest.output, longest.unit):
            raise PlotError(
                f"cannot draw output {other.output} [{other.unit}] together with "
                f"{longest.output} [{longest.unit}]; give responses of one output"
            )
        if one_record and other.record != longest.record:
            raise PlotError(
                f"cannot draw record {other.record} together with {longest.record}; "
                "give responses to one record"
            )
    return longest


def masked_words(response: Response) -> str:
    """What a caption says of the shaded stretches; nothing where there are none."""
    return "; shaded: masked, does not count" if len(response.holes) else ""
