"""Gauges that read too much or too little by a factor: the gain of each input, the scale of each output.

an input   u = (1 + g) u_read     (``input_gain``)
an output  y_read = (1 + e) y     (``sensor_scale``)
"""

from __future__ import annotations

from collections.abc import Iterator

from hybridid.effects.library import effect_named
from hybridid.model import Model
from hybridid.trace.candidates import Candidate

READINGS = {"input": "input_gain", "output": "sensor_scale"}
"""The effect of a reading that is off by a factor, by the kind of port."""


def gauges(model: Model) -> Iterator[Candidate]:
    """The reading of each input and output that ``model`` does not scale yet."""
    present = {term.name for term in model.terms}
    for port in model.plant.ports:
        if port.kind in READINGS:
            one = Candidate(effect_named(READINGS[port.kind]), port.name)
            if one.name not in present:
                yield one


def error_of(gauge: Candidate) -> str:
    """The qualified name of the relative error of ``gauge``."""
    return f"{gauge.name}.{gauge.effect.parameters[0].name}"


def is_error_of_gauge(parameter: str) -> bool:
    """Whether ``parameter`` is the relative error of a gauge, by its qualified name."""
    return _effect_of(parameter) in READINGS.values()


def put_right(parameter: str, error: float) -> str:
    """What puts a reading right of which ``parameter``, the relative error, is ``error``, in words."""
    port = parameter.partition(".")[0]
    factor = 1.0 + error if _effect_of(parameter) == READINGS["input"] else 1.0 / (1.0 + error)
    return f"the step scale of {port} by {factor:.5g}"


def _effect_of(parameter: str) -> str:
    return parameter.partition(".")[2].partition(".")[0]
