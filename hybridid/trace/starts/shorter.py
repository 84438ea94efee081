"""Where a refit starts if short horizons show it: what long ones hide.

Where a strong effect is missing, the simulated path soon leaves the measured one, and the fit of the poorer
model bends its parameters to that. What is sought along that path (``hybridid.trace.starts.sought``) is
sought in the wrong places. The cost over a long horizon has many local minima. The poorer model may stay in
one, and so may the trial of the true effect. Over horizons ``SHARE`` times as short, each of which begins
where the record is, the path stays near the measured one. So the poorer model is fitted over such horizons as
well. If a parameter then differs, it is fitted anew from there: if that ends elsewhere, its cost over long
horizons has two local minima (``Refit.two_minima``). The augmented model is fitted over short horizons, too,
and where that ends is one more start over the long ones, with the initial states that the record shows.

Source: Ribeiro, Tiels, Umenberger, Schön, Aguirre (2020), On the smoothness of nonlinear system
identification, Automatica 121, 109158.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from hybridid.model import Model
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit import (
    FAILURES,
    LEAST_DECREASE,
    WITHOUT_STD,
    refit,
    refit_if_hopeful,
    refit_if_possible,
)
from hybridid.trace.refits.refit_starts import begun_at_the_record
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.starts.sought import sought

SHARE, LEAST = 10, 8
"""By which share a horizon is divided, and the samples that it then has at least."""
BENT = 0.1
"""A parameter differs if it does by more than this share of its value. Its standard errors say nothing here:
they are large just where much is missing."""
STRAYS = 0.01
"""Held-out error, over the outputs' standard deviation, above which a path strays from the measured one.
Along a path that does not, an effect is evaluated where it acted, and long horizons hide nothing that short
ones show. A pitch, a place or a resonance may be much smaller than the whole motion, so this does not judge
these."""
ROUGHLY = 1e-3
"""Tolerance of an effect's fit over shorter horizons, which only gives a start."""
ALIKE = 0.02
"""Relative difference up to which two values of a pitch, a place or a frequency are in one valley."""
SOUGHT = ("period", "place", "frequency", "load")
"""What long horizons may hide. The longer they are, the narrower are the valleys over a frequency, and the
more impacts of a load follow from each other."""


def beside_shorter(base: Refit, context: Context) -> Refit:
    """``base`` as ``with_shorter`` has it, unless its fit over shorter horizons is known already."""
    return base if base.shorter is not None else context.one(with_shorter, base, context.split)


def with_shorter(base: Refit, split: Split) -> Refit:
    """``base``, or the lower refit from where its model ends over shorter horizons, with that end
    (``Refit.shorter``) if a parameter differs there; without one where the horizons are too short to be
    divided, or the model cannot be simulated."""
    found = over_shorter(base, split.fitted_alone)
    if found is None or not _differ(base, found):
        return base
    begun = begun_at_the_record(base, found.values, split)
    again = refit_if_possible(base.model, split, [found.values], begun, base.numerics, np.inf)
    two_minima = again is not None and again.converged and _differ(base, again)
    if again is not None and again.cost < (1 - LEAST_DECREASE) * base.cost:
        base = again
    return replace(base, shorter=found, two_minima=two_minima) if _differ(base, found) else base


def over_shorter(base: Refit, split: Split) -> Refit | None:
    """The model of ``base`` fitted over horizons ``SHARE`` times as short; None where these are too short, or
    the model cannot be simulated."""
    samples = split.horizon // SHARE
    if samples < LEAST:
        return None

    def fitted() -> Refit | None:
        shorter, begun = split.shorter(samples), [base.values]
        try:
            return refit(base.model, shorter, begun, numerics=base.numerics, std_up_to=WITHOUT_STD)
        except (ValueError, *FAILURES):
            return None

    key = ("over shorter horizons", tuple(base.values.items()), base.numerics, split)
    return base.model.kept(key, fitted)


def _differ(base: Refit, found: Refit) -> bool:
    """Whether a parameter of ``found`` differs from that of ``base``."""
    return any(abs(found.values[n] - value) > BENT * abs(value) for n, value in base.values.items())


def from_shorter(
    candidate: Candidate, model: Model, base: Refit, split: Split
) -> tuple[Mapping[str, float], Refit] | None:
    """Values to start the augmented ``model`` from, and ``base`` with the initial states that go with them.

    None where short horizons show nothing that long ones hide, where the effect explains nothing over short
    ones, and where no fit over these succeeds. What a resonance does is lost over long ones whether the fit
    differs over these or not.
    """
    fitted, poorer = split.fitted_alone, base.shorter
    if poorer is None and _resonates(candidate):
        poorer = over_shorter(base, fitted)
    if poorer is None:
        return None
    shorter = fitted.shorter(split.horizon // SHARE)
    try:
        starts = sought(candidate, model, poorer, shorter) if seeks(candidate) else None
    except (ValueError, *FAILURES):
        return None
    if starts is None:
        return _begun(model, candidate.starts(model, poorer.values), poorer, base, split, hopeful=True)
    return _begun(model, starts, poorer, base, split, hopeful=False) if starts else None


def learned_from_shorter(
    model: Model, starts: Sequence[Mapping[str, float]], base: Refit, split: Split
) -> tuple[Mapping[str, float], Refit] | None:
    """As ``from_shorter``, of the ``model`` of ``base`` with a learned effort, whose ``starts`` are those of
    long horizons. None as well where the cost of ``base`` has not ``two_minima``: a learned effort seeks no
    place, and takes what it can of a path that strays."""
    if base.shorter is None or not base.two_minima:
        return None
    moved = [{**start, **base.shorter.values} for start in starts]
    return _begun(model, moved, base.shorter, base, split, hopeful=True)


def _begun(
    model: Model,
    starts: Sequence[Mapping[str, float]],
    poorer: Refit,
    base: Refit,
    split: Split,
    hopeful: bool,
) -> tuple[Mapping[str, float], Refit] | None:
    """Where ``model`` ends over shorter horizons, beside ``poorer``, and ``base`` as it begins there; None if
    it cannot be fitted, or if it is to be ``hopeful`` and promises little."""
    shorter = split.fitted_alone.shorter(split.horizon // SHARE)
    fit = partial(refit_if_hopeful, to_beat=poorer) if hopeful else refit
    try:
        found = fit(model, shorter, starts, poorer, base.numerics, tolerance=ROUGHLY, std_up_to=WITHOUT_STD)
    except (ValueError, *FAILURES):
        return None
    return None if found.ended_early else (found.values, begun_at_the_record(base, poorer.values, split))


def hides(base: Refit) -> bool:
    """Whether long horizons may hide any effect from a fit that begins where ``base`` ended: its path strays,
    or its cost has two local minima, so that of a richer model may have them, too."""
    return strays(base) or base.two_minima


def strays(base: Refit) -> bool:
    """Whether the path of ``base`` leaves the measured one within a horizon."""
    return base.score.loss > STRAYS


def seeks(candidate: Candidate) -> bool:
    """Whether the effect has a pitch, a place, a frequency or a load."""
    return any(p.sought in SOUGHT for p in candidate.effect.parameters)


def _resonates(candidate: Candidate) -> bool:
    """Whether the effect has a load, which resonates behind its spring or contact."""
    return any(p.sought == "load" for p in candidate.effect.parameters)


def same_valley(candidate: Candidate, one: Mapping[str, float], other: Mapping[str, float]) -> bool:
    """Whether ``one`` and ``other`` (values by name) agree in all that the effect seeks; where it seeks
    nothing, or has a load, in all its parameters."""
    every = _resonates(candidate) or not seeks(candidate)
    own = [p for p in candidate.effect.parameters if (not p.fixed if every else p.sought in SOUGHT)]
    names = [f"{candidate.name}.{p.name}" for p in own]
    return all(abs(one[name] - other[name]) <= ALIKE * abs(other[name]) for name in names)
