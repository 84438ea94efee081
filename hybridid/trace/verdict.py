"""The verdict: the search, its classes looked at again, what only stands in for another effect withdrawn.

``nothing_missing`` is a claim, and needs evidence: the error that is left is near what the sensor's noise and
the simulation leave (``hybridid.trace.accuracy``), and no refused gain could take a share of it worth having.
Otherwise the verdict is ``unexplained`` or ``undecided``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hybridid.effects.composed import is_composed
from hybridid.estimators.start import regression_start
from hybridid.model import Model
from hybridid.simulation.chosen import AUTO
from hybridid.trace.accuracy import Accuracy
from hybridid.trace.ceiling import Ceiling, ceilings
from hybridid.trace.constancy import fitted_to_held_out
from hybridid.trace.context import Context
from hybridid.trace.laws import law_in_place, with_law
from hybridid.trace.numerics import numerics_for
from hybridid.trace.pairs import in_place, with_pair
from hybridid.trace.recheck import recheck
from hybridid.trace.refit import Refit
from hybridid.trace.revision import Replacement, replacements
from hybridid.trace.robustness import surviving
from hybridid.trace.rules import Rules
from hybridid.trace.search import continued, search
from hybridid.trace.split import Split
from hybridid.trace.stand_in import (
    unless_minor,
    unless_moved,
    unless_outdone,
    unless_rivalled,
    unless_varying,
    without_mixed_classes,
    without_stand_ins,
)
from hybridid.trace.steady_error import steady_over
from hybridid.trace.steps import AT_FLOOR_TOGETHER, OUT_OF_TIME, Accepted, Search

Array = NDArray[np.float64]
MOST_TOLD = 3
"""Places where structure remains, the strongest, that are looked at and named."""
Ceilings = tuple[Ceiling, ...]
Verdict = Literal["effect_found", "ambiguous", "law_proposed", "nothing_missing", "undecided", "unexplained"]


@dataclass(frozen=True)
class Conclusion:
    """What the search found, by which path, and what remains.

    ``accuracy`` is what a complete model would leave of each output, and ``times`` the held-out error of the
    last model over that. ``ceilings`` hold the held-out gain that a learned effort could still bring to the
    last model, by port and variable; ``ceilings_before`` to the declared one (empty where it was not needed:
    fewer than two effects). ``remains`` names where structure is left that no effect of the library explains.
    ``refused`` says which gain worth having a test refused, where that leaves the verdict open.
    ``steady`` is the length [s] of shorter horizons over which the error is as large, where that leaves the
    verdict open. ``replacements`` do better in the place of a declared effect, where that was asked.
    ``there`` is the last model, fitted to the held-out horizons alone, if effects were accepted.
    ``out_of_time``: the time limit left out steps, pairs, laws or replacements.
    """

    verdict: Verdict
    search: Search
    accuracy: Accuracy
    ceilings: Ceilings
    ceilings_before: Ceilings
    remains: tuple[str, ...]
    times: float
    refused: str = ""
    steady: float | None = None
    replacements: tuple[Replacement, ...] = ()
    there: Refit | None = None
    out_of_time: bool = False

    @property
    def model(self) -> Model:
        """The last model: the declared one and what was accepted."""
        return self.search.final.model

    @property
    def accepted(self) -> tuple[Accepted, ...]:
        """The accepted effects, in the order in which they were found."""
        return self.search.accepted


def conclude(
    model: Model,
    context: Context,
    start: Sequence[Mapping[str, float]] = (),
    integrator: str = AUTO,
) -> Conclusion:
    """Find what ``model`` lacks on the horizons of ``context``.

    ``start`` holds parameter values to start from (none: by regression, and the guesses; the better one is
    carried on). ``integrator`` solves the equations ("auto": the one that the starts need), and the other one
    checks it.

    Raises:
        ValueError: if a record does not fit the model or it diverges on the records.
    """
    split, rules = context.split, context.rules
    starts = start or [regressed(model, split), {}]  # where the motion hides a parameter, regression strays
    found = search(model, context, starts, numerics_for(model, split, starts, integrator))
    settled, cut = _with_more(_settled(found, context), context)
    refused, steady = _refused(settled, rules), _steady(settled, context)
    revises = context.revise and not context.out_of_time
    revised = replacements(model, settled.found, context) if revises else ()
    return Conclusion(
        verdict=_verdict(settled, refused, steady, rules),
        search=settled.found,
        accuracy=settled.accuracy,
        ceilings=settled.left,
        ceilings_before=settled.before,
        remains=settled.remains,
        times=settled.times,
        refused=refused,
        steady=steady,
        replacements=revised,
        there=fitted_to_held_out([settled.found.final], context)[0] if settled.found.accepted else None,
        out_of_time=cut or revises != context.revise,
    )


@dataclass(frozen=True, eq=False)
class _Settled:
    """What is left of a search after every doubt; the fields as ``Conclusion`` has them."""

    found: Search
    left: Ceilings
    before: Ceilings
    accuracy: Accuracy
    times: float
    remains: tuple[str, ...]


def _is_left(settled: _Settled, rules: Rules) -> bool:
    """Whether something is left that no effect explains."""
    return bool(settled.remains) or settled.times > rules.far


def _with_more(settled: _Settled, context: Context) -> tuple[_Settled, bool]:
    """``settled`` with pairs and laws, and whether the time limit left these or further steps out."""
    for seek in (_with_pairs, _with_laws) if context.laws else (_with_pairs,):
        cut = settled.found.stopped == OUT_OF_TIME
        if cut or context.out_of_time:
            return settled, cut or _is_left(settled, context.rules)
        settled = seek(settled, context)
    return settled, settled.found.stopped == OUT_OF_TIME


def _with_pairs(settled: _Settled, context: Context) -> _Settled:
    """``settled`` with pairs of effects, and what is found beside them, as long as something is left: beside
    what was accepted, else in its place.

    They come before laws: two known effects say more of a machine than one formula that fits as well.
    """
    settled = _beside_pairs(settled, context)
    if not (_is_left(settled, context.rules) and context.pairs):
        return settled
    replaced = in_place(settled.found, context)
    if replaced is settled.found:
        return settled
    other = _settled(continued(replaced, context), context)
    return _beside_pairs(other, context) if other.found.accepted else settled


def _beside_pairs(settled: _Settled, context: Context) -> _Settled:
    """``settled`` with pairs beside what was accepted."""
    for _ in range(context.rules.most_effects // 2):
        if not _is_left(settled, context.rules):
            break
        tried = with_pair(settled.found, context)
        if tried is settled.found or not tried.steps[-1].taken:
            return replace(settled, found=tried)
        settled = _settled(continued(tried, context), context)
    return settled


def _with_laws(settled: _Settled, context: Context) -> _Settled:
    """``settled`` with a composed law, and what is found beside it: beside what was accepted where something
    is left, and in the place of effects that a law may outdo."""
    if _is_left(settled, context.rules):
        lawful = with_law(settled.found, settled.left, context)
        if lawful is not settled.found:
            settled = _settled(continued(lawful, context), context)
    found = settled.found
    if not _may_be_outdone(settled, context.rules):
        return settled
    lawful = law_in_place(found, settled.before or _learned_beside(found.first, found, context), context)
    if lawful is found:
        return settled
    other = _settled(continued(lawful, context), context)
    return other if other.found.accepted else settled


def _may_be_outdone(settled: _Settled, rules: Rules) -> bool:
    """Whether names were accepted for which one law may stand: several, or one beside which something is
    left."""
    accepted = settled.found.accepted
    names = [one for one in accepted if not is_composed(one.trial.candidate.effect)]
    return bool(names) and (len(accepted) > 1 or _is_left(settled, rules))


def _settled(found: Search, context: Context) -> _Settled:
    """``found`` with its classes looked at again, and without what stands in for something else."""
    found, left, before = _trusted(_with_sound_classes(found, context), context)
    accuracy, times = _error_left(found.final, context)
    kept = unless_minor(found, times, context.rules)
    if kept is found:
        kept = unless_moved(found, context)
    if kept is found:
        kept = unless_varying(found, context)
    if kept is not found:
        found, left = kept, _beside_last(kept, before, context)
        accuracy, times = _error_left(found.final, context)
    return _Settled(found, left, before, accuracy, times, _remaining(found, left, context))


def _with_sound_classes(found: Search, context: Context) -> Search:
    """``found`` with its classes looked at again, also those that a withdrawal brings back."""
    looked_at = recheck(found, context)
    kept = without_mixed_classes(looked_at)
    if kept is looked_at or not kept.accepted:
        return kept
    return _with_sound_classes(kept, context)


def _remaining(found: Search, left: Ceilings, context: Context) -> tuple[str, ...]:
    """The strongest places where a learned effort still finds something that survives other numerics."""
    told = _telling(left, context.rules)[:MOST_TOLD]
    return tuple(f"at {told[k].place}" for k in surviving([c.refit for c in told], found.final, context))


def regressed(model: Model, split: Split) -> dict[str, float]:
    """Parameter values to start from: by regression on the fitted records, else the guesses."""
    records = [split.records[k] for k in sorted({_record_of(split, h) for h in split.fitted})]
    start = regression_start(model, records)
    values = model.values() if start is None else start
    return {q.name: float(v) for q, v in zip(model.parameters, values, strict=True)}


def _record_of(split: Split, horizon: int) -> int:
    counts = np.cumsum([-(-record.n // split.horizon) for record in split.records])
    return min(int(np.searchsorted(counts, horizon, side="right")), len(split.records) - 1)


def _trusted(found: Search, context: Context) -> tuple[Search, Ceilings, Ceilings]:
    """``found`` without what stands in for something else, with the ceilings of its last model, and of the
    declared one if several effects had to be held against them."""
    before = _learned_beside(found.first, found, context) if len(found.accepted) > 1 else ()
    kept = unless_outdone(found, before, context.rules)
    if kept is not found:
        return kept, _beside_last(kept, before, context), before
    after = _learned_beside(found.final, found, context)
    kept = without_stand_ins(found, after, context)
    if kept is found:
        kept = unless_rivalled(found, context)
    return kept, (after if kept is found else _learned_beside(kept.final, kept, context)), before


def _beside_last(found: Search, before: Ceilings, context: Context) -> Ceilings:
    """The ceilings of the last model; ``before`` are those of the declared one, if they are known."""
    return before if before and found.final is found.first else _learned_beside(found.final, found, context)


def _learned_beside(model: Refit, found: Search, context: Context) -> Ceilings:
    """The learned efforts beside ``model``, those of a step of ``found`` if it was held against them.

    None where the last model meets the noise on all horizons together: only its parameters are uncertain, and
    a learned effort could take what they err by.
    """
    if model is found.final and found.stopped == AT_FLOOR_TOGETHER:
        return ()
    known = (step.learned for step in found.steps if step.base is model and step.learned)
    return next(known, ()) or ceilings(model, context)


def _error_left(final: Refit, context: Context) -> tuple[Accuracy, float]:
    """What a complete model would leave in the place of ``final``, and the error of ``final`` over that."""
    accuracy = Accuracy.of(final, context)
    return accuracy, accuracy.times(final.score.rmse)


def _telling(found: Sequence[Ceiling], rules: Rules) -> list[Ceiling]:
    """The learned efforts that still find something, the best first.

    Those that find less than half of what the best does are left out: over the wrong variable a little of
    everything can be found.
    """
    passing = [c for c in found if c.passes(rules)]
    most = max((c.gain for c in passing), default=0.0)
    return sorted((c for c in passing if c.gain >= most / 2), key=lambda c: -c.gain)


def _steady(settled: _Settled, context: Context) -> float | None:
    """The length [s] of shorter horizons over which the error that is left is as large, where nothing else
    tells of it: it is far above the noise, and neither an effect nor a learned effort takes any of it."""
    found, rules = settled.found, context.rules
    told = found.accepted or settled.remains or found.withdrawn or settled.times <= rules.far
    return None if told else steady_over(found.final, context)


def _verdict(settled: _Settled, refused: str, steady: float | None, rules: Rules) -> Verdict:
    """One word: a law, an effect found alone or in a class, something left unnamed, open, or nothing."""
    found = settled.found
    if any(is_composed(one.trial.candidate.effect) for one in found.accepted):
        return "law_proposed"
    if found.accepted:
        return "ambiguous" if any(len(one.alike) > 1 for one in found.accepted) else "effect_found"
    if steady is not None:
        return "undecided"
    if settled.remains or found.withdrawn or settled.times > rules.far:
        return "unexplained"
    return "undecided" if refused else "nothing_missing"


def _refused(settled: _Settled, rules: Rules) -> str:
    """The largest gain worth having that the last model was refused; empty if there is none.

    Noise and simulation leave ``1 / times`` of the error. A gain that would take more than the rest took a
    part of the noise or of the simulation's error, and tells nothing of the machine.
    """
    found, most = settled.found, 1.0 - 1.0 / settled.times
    tried = found.steps[-1].trials if found.steps and found.steps[-1].accepted is None else ()
    gains = [
        *((t.gain, f"{t.candidate.name}, refused: {t.reason}") for t in tried),
        *((c.gain, f"{c.described}, p = {c.p_value:.2g}") for c in settled.left),
    ]
    possible = [(gain, what) for gain, what in gains if rules.worth <= gain <= most]
    if not possible:
        return ""
    gain, what = max(possible)
    return f"{gain:.1%} with {what}"
