"""Whether a record shows that something repeats: a sine of free period fits any short curve.

Over less than one period, a sine of free amplitude, phase and period bends like a cubic polynomial. So an
effect that is periodic in position or time counts only where the records cover ``LEAST`` periods: then its
form repeats at least twice. A frequency above half the sampling frequency cannot be told from a lower
one (Nyquist). A resonance (an effect with states) claims no repetition, but must oscillate: far above its
frequency the load stands still, and its spring acts as a spring to the ground. So one period must fit into
a record. Source: Bretthorst (1988), Bayesian Spectrum Analysis and Parameter Estimation, ch. 6.
"""

from __future__ import annotations

import numpy as np

from hybridid.effects.effect import EffectParameter
from hybridid.quantities import quantity
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import Split
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refitted import Refit

LEAST = 3
"""Periods that the fitted horizons of one record must cover."""
OF_A_RESONANCE = 1
"""Periods of a resonance that the longest record must cover."""


def not_repeated(candidate: Candidate, found: Refit, split: Split) -> str:
    """Why the records do not show the fitted period or frequency of the effect; empty if they do."""
    if candidate.effect.kind == "input":
        return ""
    for parameter in candidate.effect.parameters:
        name = f"{candidate.name}.{parameter.name}"
        free = not next(p for p in found.model.parameters if p.name == name).fixed
        if free and parameter.sought == "period":
            return _too_long(parameter, candidate, found, split)
        if free and parameter.sought == "frequency":
            judged = _too_slow if candidate.effect.states else _not_sampled
            return judged(abs(found.values[name]), split)
    return ""


def _too_long(parameter: EffectParameter, candidate: Candidate, found: Refit, split: Split) -> str:
    period = abs(found.values[f"{candidate.name}.{parameter.name}"])
    visited = float(np.ptp(Path.of(found, split, split.fitted).place(candidate.port)))
    if visited >= LEAST * period:
        return ""
    unit = parameter.dimension.unit(found.model.plant.port(candidate.port))
    return (
        f"the records cover {quantity(visited, unit, 3)}, or {visited / period:.1f} of its periods of "
        f"{quantity(period, unit, 3)}; {LEAST} are needed to show that it repeats"
    )


def _not_sampled(frequency: float, split: Split) -> str:
    dt = max(record.dt for record in split.records)
    longest = _longest(split)
    if frequency > 0.5 / dt:
        return f"its frequency of {frequency:.3g} Hz is above half the sampling frequency, {0.5 / dt:.3g} Hz"
    if frequency * longest < LEAST:
        return (
            f"the longest record of {longest:.3g} s covers {frequency * longest:.1f} periods of its "
            f"{frequency:.3g} Hz; {LEAST} are needed to show that it repeats"
        )
    return ""


def _too_slow(frequency: float, split: Split) -> str:
    longest = _longest(split)
    if frequency * longest < OF_A_RESONANCE:
        return (
            f"the longest record of {longest:.3g} s is shorter than one period of its {frequency:.3g} Hz: "
            "in so short a time such a load hardly moves, and acts as a spring to the ground"
        )
    return ""


def _longest(split: Split) -> float:
    """The duration of the longest record in s."""
    return max(record.n * record.dt for record in split.records)
