"""Where a refit starts if short horizons show it: a pitch or a place that long ones hide.

Where a strong effect is missing, the simulated path soon leaves the measured one, and the fit of the poorer
model bends every parameter to it. What is sought along that path (``hybridid.trace.sought``) is sought in the
wrong places, and the cost over a long horizon has many local minima. Over horizons ``SHARE`` times as short,
each of which begins where the record is, the path stays near the measured one. So the poorer model and the
augmented one are fitted over such horizons first. Where that ends is one more start over the long ones, with
the initial states that the record shows.

Source: Ribeiro, Tiels, Umenberger, Schön, Aguirre (2020), On the smoothness of nonlinear system
identification, Automatica 121, 109158.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from hybridid.model import Model
from hybridid.trace.candidates import Candidate
from hybridid.trace.refit import FAILURES, WITHOUT_STD, Refit, begin, refit
from hybridid.trace.sought import sought
from hybridid.trace.split import Split

SHARE, LEAST = 10, 8
"""By which share a horizon is divided, and the samples that it then has at least."""
ALIKE = 0.02
"""Relative difference up to which two values of a pitch or a place are in one valley of the cost."""
SOUGHT = ("period", "place")
"""What long horizons may hide."""


def from_shorter(
    candidate: Candidate, model: Model, base: Refit, split: Split
) -> tuple[Mapping[str, float], Refit] | None:
    """Values to start the augmented ``model`` from, and ``base`` with the initial states that go with them.

    None for effects that seek neither a period nor a place, where horizons are too short to be divided, and
    where a fit over shorter ones fails.
    """
    samples = split.horizon // SHARE
    if samples < LEAST or not any(p.sought in SOUGHT for p in candidate.effect.parameters):
        return None
    shorter = split.shorter(samples)
    try:
        poorer = refit(base.model, shorter, [base.values], numerics=base.numerics, std_up_to=WITHOUT_STD)
        starts = sought(candidate, model, poorer, shorter)
        if not starts:
            return None
        found = refit(model, shorter, starts, poorer, base.numerics, std_up_to=WITHOUT_STD)
    except (ValueError, *FAILURES):
        return None
    problem = base.problem(split)
    begun = begin(problem, base.model.values(poorer.values), None, base.numerics)
    return found.values, replace(base, x0=begun.x0)


def same_valley(candidate: Candidate, one: Mapping[str, float], other: Mapping[str, float]) -> bool:
    """Whether ``one`` and ``other`` (values by name) agree in all that the effect seeks."""
    names = [f"{candidate.name}.{p.name}" for p in candidate.effect.parameters if p.sought in SOUGHT]
    return all(abs(one[name] - other[name]) <= ALIKE * abs(other[name]) for name in names)
