"""``Trial``: one candidate, refitted and judged."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hybridid.model import Model
from hybridid.trace.candidates import Candidate, each_once
from hybridid.trace.horizons.evidence import Comparison, compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.numerics import Numerics
from hybridid.trace.refits.refit import (
    LEAST_DECREASE,
    judged_up_to,
    least_of,
    refit,
    refit_beside,
    refit_if_possible,
)
from hybridid.trace.refits.refit_starts import begun_at_the_record
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.starts.guess_starts import from_guesses
from hybridid.trace.starts.shorter import from_shorter, hides, same_valley, seeks
from hybridid.trace.starts.shown import not_shown
from hybridid.trace.starts.solve import by_either_integrator
from hybridid.trace.starts.sought import known_means, sought
from hybridid.trace.starts.switched_on import settled_or_switched_on
from hybridid.trace.starts.valley import along_the_valley

ABOVE = 1.2
"""Times another parameter that a fixed one is set to: see ``EffectParameter.above``."""
QUARTER = 0.25
"""Of what an effect takes: the least that another one in its place must promise, of the fitted cost or of the
held-out RMSE, to be refitted to the end. Only what the records cannot tell from the effect counts there. That
takes at least half as much, unless few horizons judge (``hybridid.trace.trials.alike``); a quarter leaves
room."""
PASSED, REJECTED, UNIDENTIFIABLE, UNTRIED = "passed", "rejected", "unidentifiable", "untried"


@dataclass(frozen=True)
class Trial:
    """A candidate's refit, its evidence over the model without it, and what was decided.

    ``fitted_gain`` is the share that it takes from the squared error of the fitted horizons. ``failure`` says
    why it could not be fitted, ``not_shown`` why the records cannot show its form. ``seconds`` are those of
    all its refits, with both integrators.
    """

    candidate: Candidate
    refit: Refit | None
    comparison: Comparison | None
    fitted_gain: float = 1.0
    p_adjusted: float = 1.0
    status: str = REJECTED
    reason: str = ""
    failure: str = ""
    not_shown: str = ""
    seconds: float = 0.0

    @property
    def gain(self) -> float:
        """Relative decrease of the held-out loss; minus infinity without a comparison."""
        return self.comparison.gain if self.comparison else -math.inf

    @property
    def taken(self) -> float:
        """What the effect takes from the held-out squared error, over the outputs' variances."""
        if self.refit is None or not math.isfinite(self.gain):
            return 0.0
        after = self.refit.score.loss**2
        return after / (1.0 - self.gain) ** 2 - after

    @property
    def free_parameters(self) -> int:
        """How many of the effect's own parameters are estimated."""
        return self.candidate.free_parameters

    def own(self, quantity: str) -> dict[str, float]:
        """The effect's own ``values`` or ``std`` by short name; a known constant has no std."""
        assert self.refit is not None
        table, prefix = getattr(self.refit, quantity), f"{self.candidate.name}."
        return {name.removeprefix(prefix): value for name, value in table.items() if name.startswith(prefix)}


def share_of(richer: Refit | None, base: Refit) -> float:
    """The share that ``richer`` takes from both the fitted cost and the held-out RMSE of ``base``; 0 if it is
    None, or takes nothing."""
    if richer is None or base.cost <= 0 or base.score.loss <= 0:
        return 0.0
    return max(0.0, 1.0 - max(richer.cost / base.cost, richer.score.loss / base.score.loss))


@np.errstate(over="ignore", invalid="ignore")  # a start may diverge
def attempt(
    candidate: Candidate,
    base: Refit,
    split: Split,
    worth: float = Rules.worth,
    rival: Refit | None = None,
    in_place_of: Refit | None = None,
) -> Trial:
    """Add the candidate to the base model, refit everything, compare on held-out horizons.

    A trial that may be chosen then goes on along its valley: see ``hybridid.trace.trials.tried``.

    A refit that promises little ends early: less than ``LEAST_DECREASE``, and than half of ``worth``, of the
    fitted cost and of the held-out RMSE of ``base``, or of a ``rival`` that it is to replace. One that takes
    so little of the RMSE of ``base`` has no standard errors. Where the candidate takes the place of an
    effect, with which the model ends at ``in_place_of``, it is asked for a quarter of what that takes.

    What is too stiff for the integrator of ``base`` is tried again with the implicit one: the starts that it
    could not solve, or all if the end is too stiff. That trial counts if it explains more: else everything
    that follows would be solved the slow way for nothing.
    """
    began = time.perf_counter()
    least = max(least_of(worth), QUARTER * share_of(in_place_of, base))
    trial = _solved(candidate, base, split, least, rival)
    return replace(trial, seconds=time.perf_counter() - began)


def _solved(candidate: Candidate, base: Refit, split: Split, least: float, rival: Refit | None) -> Trial:
    """The trial by the integrator of ``base``, or by the implicit one where that is needed and better."""

    def solve(numerics: Numerics, to_beat: Refit, chosen: Sequence[int] | None) -> Trial:
        lowest = min(filter(None, (to_beat, rival)), key=lambda one: one.cost)
        return _attempt(candidate, base, split, numerics, lowest, least, chosen)

    return by_either_integrator(solve, base)


def _attempt(
    candidate: Candidate,
    base: Refit,
    split: Split,
    numerics: Numerics,
    to_beat: Refit,
    least: float,
    chosen: Sequence[int] | None = None,
) -> Trial:
    """The trial from all starts, or from the ``chosen`` ones by number; ``to_beat`` and ``least`` as in
    ``refit_if_hopeful``."""
    model: Model = candidate.added_to(base.model)
    try:
        known = known_means(candidate, model, split)
        places = sought(candidate, model, base, split)
        starts = [*candidate.starts(model, base.values), *places]
        starts = [{**starts[k], **known} for k in (range(len(starts)) if chosen is None else chosen)]
        found = refit_beside(base, model, split, starts, numerics, to_beat, least)
        found = _begun_anew(found, base, split) if found.converged else found
        if chosen is None:  # else the trial of the other starts has looked there, and was solved
            found = _unless_better_where_sought(found, candidate, places, base, split, least)
            found = _unless_better_from_shorter(found, candidate, base, split, least)
            found = _unless_better_from_guesses(found, candidate, base, split, least)
        if _promises(found, base, least):
            found = settled_or_switched_on(found, candidate, split)
            found = _with_form_fitted(found, candidate, split)
    except (ValueError, ArithmeticError) as error:
        return Trial(candidate, None, None, failure=str(error))
    if not math.isfinite(found.cost):
        return Trial(candidate, None, None, failure="the simulation diverges from every start")
    return _ended(candidate, found, base, split)


def gone_on(trial: Trial, base: Refit, split: Split) -> Trial:
    """``trial``, its refit gone on along its valley (``hybridid.trace.starts.valley``), if that explains
    more. It stays where the valley cannot be simulated: a place to go on from is no part of the evidence."""
    assert trial.refit is not None
    began = time.perf_counter()
    try:
        found = along_the_valley(trial.refit, trial.candidate, base, split)
    except (ValueError, ArithmeticError):
        return trial
    ended = _ended(trial.candidate, found, base, split)
    return replace(ended, seconds=trial.seconds + time.perf_counter() - began)


def begun_from(trial: Trial, poorer: Refit, base: Refit, split: Split, worth: float = Rules.worth) -> Trial:
    """``trial`` beside ``base``, refitted from where an effect with a part of its parameters ended
    (``poorer``), if that explains more."""
    began, candidate = time.perf_counter(), trial.candidate
    kept = {name: value for name, value in poorer.values.items() if name in base.values}
    lent = {name.rsplit(".", 1)[-1]: poorer.values[name] for name in poorer.values.keys() - kept.keys()}
    own = [p.name for p in candidate.effect.parameters if not p.fixed and p.name in lent]
    shared = {f"{candidate.name}.{name}": lent[name] for name in own}
    try:
        model = candidate.added_to(base.model)
        starts = each_once([{**start, **shared} for start in candidate.starts(model, kept)])
        found = refit_beside(base, model, split, starts, base.numerics, base, least_of(worth))
    except (ValueError, ArithmeticError):
        return trial
    if not found.cost < (trial.refit.cost if trial.refit else math.inf):
        return trial
    ended = _ended(candidate, found, base, split)
    return replace(ended, seconds=trial.seconds + time.perf_counter() - began)


def _ended(candidate: Candidate, found: Refit, base: Refit, split: Split) -> Trial:
    """The trial that ended at ``found``, with its evidence over ``base``."""
    evidence = compare(base.score, found.score)
    fitted_gain = max(0.0, 1.0 - found.cost / base.cost) if base.cost > 0 else 0.0
    return Trial(candidate, found, evidence, fitted_gain, not_shown=not_shown(candidate, found, split))


def _begun_anew(found: Refit, base: Refit, split: Split) -> Refit:
    """``found``, or its refit with the initial states that the record shows, if it diverges held out.

    The initial states of ``base`` are lent. Where the effect makes the held-out motion unstable (a damping
    that becomes negative), horizons that begin a little beside the record diverge, though the model is right.
    """
    if math.isfinite(found.score.loss):
        return found
    begun = begun_at_the_record(base, base.values, split)
    return refit(found.model, split, [found.values], begun, found.numerics)


def _promises(found: Refit, base: Refit, least: float) -> bool:
    """Whether the trial that ended at ``found`` takes as much of the held-out RMSE as it must."""
    return found.score.loss <= (1 - least) * base.score.loss


def _with_form_fitted(found: Refit, candidate: Candidate, split: Split) -> Refit:
    """``found``, or its refit with each fixed parameter that is best a little above another one set there, if
    that explains more."""
    values, name = dict(found.values), candidate.name
    for p in candidate.effect.parameters:
        if p.above:
            values[f"{name}.{p.name}"] = max(ABOVE * values[f"{name}.{p.above}"], p.lower)
    if values == found.values:
        return found
    again = refit_if_possible(found.model, split, [values], found, found.numerics, math.inf)
    return found if again is None or again.cost >= found.cost else again


def _unless_better_where_sought(
    found: Refit,
    candidate: Candidate,
    places: Sequence[Mapping[str, float]],
    base: Refit,
    split: Split,
    least: float,
) -> Refit:
    """``found``, or the refit from the pitches or ``places`` that the record shows, if that explains more.

    The record shows them at the smoothing of ``base``. A wider one may leave more than the effect does,
    and the descent through it leads to a place where the effect mends that. So this one is as sharp as the
    model is declared. An effect with inner states begins over shorter horizons (``from_shorter``).
    """
    arrived = any(same_valley(candidate, place, found.values) for place in places)
    if not places or arrived or candidate.inner_states or not seeks(candidate):
        return found
    return _lower_from(places, base, found, base, split, least)


def _unless_better_from_shorter(
    found: Refit, candidate: Candidate, base: Refit, split: Split, least: float
) -> Refit:
    """``found``, or the refit from where shorter horizons end, if that explains more. That start is fitted as
    sharply as the model is declared, so it is not led there through wider smoothings.

    An effect that seeks neither a pitch nor a place starts there only where long horizons may hide it.
    """
    if not (seeks(candidate) or hides(base)):
        return found
    shorter = from_shorter(candidate, found.model, base, split)
    if shorter is None or same_valley(candidate, shorter[0], found.values):
        return found
    start, begun = shorter
    return _lower_from([start], begun, found, base, split, least)


def _unless_better_from_guesses(
    found: Refit, candidate: Candidate, base: Refit, split: Split, least: float
) -> Refit:
    """``found``, or the refit from the guesses, where there is one and it explains more."""
    begun = from_guesses(candidate, found.model, base, split)
    return found if begun is None else _lower_from([begun[0]], begun[1], found, base, split, least)


def _lower_from(
    starts: Sequence[Mapping[str, float]],
    begun: Refit,
    found: Refit,
    base: Refit,
    split: Split,
    least: float,
) -> Refit:
    """``found``, or the refit of its model from the best of ``starts``, with the initial states of ``begun``,
    if that is lower."""
    std_up_to, lower = judged_up_to(base, least), (1 - LEAST_DECREASE) * found.cost
    again = refit_if_possible(found.model, split, starts, begun, found.numerics, std_up_to, lower)
    return found if again is None or again.cost >= lower else again
