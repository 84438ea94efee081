"""The verdict: the search, its classes looked at again, what only stands in for another effect withdrawn.

``nothing_missing`` is a claim, and needs evidence: the error that is left is near what the sensor's noise and
the simulation leave (``hybridid.trace.noise_floor.accuracy``), and no refused gain could take a share of it
worth having. Otherwise the verdict is ``unexplained`` or ``undecided``; the latter, too, where noise of the
inputs may be all that is left (``hybridid.trace.noise_floor.input_noise``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from hybridid.effects.composed import is_composed
from hybridid.model import Model
from hybridid.simulation.chosen import AUTO
from hybridid.trace.context import Context
from hybridid.trace.doubts.other_hold import better_hold
from hybridid.trace.doubts.settled import Ceilings, Settled, learned_beside, settle, settle_below_noise
from hybridid.trace.doubts.steady_error import steady_over
from hybridid.trace.laws.laws import law_in_place, with_law
from hybridid.trace.noise_floor.accuracy import Accuracy
from hybridid.trace.noise_floor.input_noise import NoisyInputs, noisy_inputs
from hybridid.trace.refits.declared_starts import declared_starts
from hybridid.trace.refits.numerics import numerics_for
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.longer import Longer, more_over_longer, shows_little, worth_looking_for
from hybridid.trace.search.pairs import in_place, with_pair
from hybridid.trace.search.revision import Replacement, replacements
from hybridid.trace.search.search import continued, search
from hybridid.trace.search.steps import OUT_OF_TIME, RECORDINGS_DIFFER, Accepted, Search
from hybridid.trace.trials.constancy import told_of_held_out
from hybridid.trace.trials.judgement import is_nothing

Verdict = Literal["effect_found", "ambiguous", "law_proposed", "nothing_missing", "undecided", "unexplained"]


@dataclass(frozen=True)
class Conclusion:
    """What the search found, by which path, and what remains.

    ``accuracy`` is what a complete model would leave of each output, ``times`` the held-out error of the
    last model over that, and ``times_fitted`` its error on the fitted horizons. ``ceilings`` hold the
    held-out gain that a learned effort could still bring to the last model, by port and variable;
    ``ceilings_before`` to the declared one (empty where it was not needed: fewer than two effects).
    ``remains`` names where structure is left that no effect of the library explains.
    ``refused`` says which gain worth having a test refused, where that leaves the verdict open.
    ``steady`` is the length [s] of shorter horizons over which the error is as large, where that leaves the
    verdict open. So does what is left over ``longer`` horizons, and so do horizons that are ``too_short``,
    and parameters so ``vague`` that they alone may err by what is left.
    ``replacements`` do better in the place of a declared effect, where that was asked; unless the time limit
    left that out (``unrevised``).
    ``grows`` is what longer horizons leave where that is too little to leave the verdict open, but more than
    a complete model would.
    ``other_hold`` says in words which other hold of the inputs explains what is left. ``noisy`` is the noise
    of the inputs that would, too.
    ``there`` is the last model, fitted to the held-out horizons alone, if effects were accepted.
    ``out_of_time``: the time limit left out effects, steps, pairs, laws or replacements.
    """

    verdict: Verdict
    search: Search
    accuracy: Accuracy
    ceilings: Ceilings
    ceilings_before: Ceilings
    remains: tuple[str, ...]
    times: float
    times_fitted: float
    refused: str = ""
    steady: float | None = None
    longer: Longer | None = None
    grows: Longer | None = None
    too_short: bool = False
    vague: bool = False
    other_hold: str = ""
    noisy: NoisyInputs | None = None
    replacements: tuple[Replacement, ...] = ()
    unrevised: bool = False
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
    starts = declared_starts(model, split, start)
    found = search(model, context, starts, numerics_for(model, split, starts, integrator))
    settled, cut = _with_more(settle_below_noise(found, context), context)
    refused, steady = _refused(settled, rules), _steady(settled, context)
    fitted = settled.accuracy.times_the_least(settled.found.final.fitted_rmse)
    verdict = _verdict(settled, refused, steady, fitted, rules, cut)
    noisy = noisy_inputs(settled.found.final, settled.accuracy, context)
    if noisy and verdict == "unexplained" and not (settled.remains or settled.found.withdrawn):
        verdict = "undecided"
    silent = verdict == "nothing_missing"
    near = not settled.found.accepted and settled.times <= rules.far
    longer = more_over_longer(settled.found.final, context) if near else None
    if silent and longer:
        verdict = "undecided"
    grows = None
    if silent and not longer:
        grows = more_over_longer(settled.found.final, context, worth_looking_for(rules))
    too_short = silent and shows_little(split)
    vague = silent and _parameters_are_vague(settled, rules)
    revises = context.revise and not context.out_of_time
    revised = replacements(model, settled.found, context) if revises else ()
    return Conclusion(
        verdict="undecided" if too_short or vague else verdict,
        search=settled.found,
        accuracy=settled.accuracy,
        ceilings=settled.left,
        ceilings_before=settled.before,
        remains=settled.remains,
        times=settled.times,
        times_fitted=fitted,
        refused=refused,
        steady=steady,
        longer=longer,
        grows=grows,
        too_short=too_short,
        vague=vague,
        other_hold=better_hold(settled.found.final, context),
        noisy=noisy,
        replacements=revised,
        unrevised=revises != context.revise,
        there=told_of_held_out(settled.found.final, context) if settled.found.accepted else None,
        out_of_time=cut or revises != context.revise,
    )


def _with_more(settled: Settled, context: Context) -> tuple[Settled, bool]:
    """``settled`` with pairs and laws, and whether the time limit left these or further steps out."""
    if settled.found.stopped == RECORDINGS_DIFFER:  # combinations are more physics than that
        return settled, False
    for seek in (_with_pairs, _with_laws) if context.laws else (_with_pairs,):
        cut = settled.found.stopped == OUT_OF_TIME
        if cut or context.out_of_time:
            return settled, cut or settled.is_open(context.rules)
        settled = seek(settled, context)
    cut = settled.found.stopped == OUT_OF_TIME
    return settled, cut or (context.out_of_time and settled.is_open(context.rules))


def _with_pairs(settled: Settled, context: Context) -> Settled:
    """``settled`` with pairs of effects, and what is found beside them, as long as something is left: beside
    what was accepted, else in its place.

    They come before laws: two known effects say more of a machine than one formula that fits as well.
    """
    settled = _beside_pairs(settled, context)
    if not (settled.is_open(context.rules) and context.pairs):
        return settled
    replaced = in_place(settled.found, context)
    if replaced is settled.found:
        return settled
    other = settle(continued(replaced, context), context)
    return _beside_pairs(other, context) if other.found.accepted else settled


def _beside_pairs(settled: Settled, context: Context) -> Settled:
    """``settled`` with pairs beside what was accepted."""
    for _ in range(context.rules.most_effects // 2):
        if not settled.is_open(context.rules):
            break
        tried = with_pair(settled.found, context)
        if tried is settled.found or not tried.steps[-1].taken:
            return replace(settled, found=tried)
        settled = settle(continued(tried, context), context)
    return settled


def _with_laws(settled: Settled, context: Context) -> Settled:
    """``settled`` with a composed law, and what is found beside it: beside what was accepted where something
    is left, and in the place of effects that a law may outdo."""
    if settled.is_open(context.rules):
        lawful = with_law(settled.found, settled.left, context)
        if lawful.final is settled.found.final:
            settled = replace(settled, found=lawful)
        else:
            settled = settle(continued(lawful, context), context)
    found = settled.found
    if not _may_be_outdone(settled, context.rules):
        return settled
    lawful = law_in_place(found, settled.before or learned_beside(found.first, found, context), context)
    if lawful is found:
        return settled
    other = settle(continued(lawful, context), context)
    return other if other.found.accepted else settled


def _may_be_outdone(settled: Settled, rules: Rules) -> bool:
    """Whether names were accepted for which one law may stand: several, or one beside which something is
    left."""
    accepted = settled.found.accepted
    names = [one for one in accepted if not is_composed(one.trial.candidate.effect)]
    return bool(names) and (len(accepted) > 1 or settled.is_open(rules))


def _steady(settled: Settled, context: Context) -> float | None:
    """The length [s] of shorter horizons over which the error that is left is as large, where nothing else
    tells of it: it is far above the noise, and neither an effect nor a learned effort takes any of it."""
    found, rules = settled.found, context.rules
    told = found.accepted or settled.remains or found.withdrawn or settled.times <= rules.far
    return None if told else steady_over(found.final, context)


def _verdict(
    settled: Settled, refused: str, steady: float | None, times_fitted: float, rules: Rules, cut: bool = False
) -> Verdict:
    """One word: a law, an effect found alone or in a class, something left unnamed, open, or nothing.

    Open, too, where the time limit has ``cut`` a search that leaves far more than noise and simulation do:
    what was accepted first may stand for what the rest of the search would have put in its place.
    """
    found = settled.found
    if cut and found.accepted and settled.times > rules.far:
        return "undecided"
    if any(is_composed(one.trial.candidate.effect) for one in found.accepted):
        return "law_proposed"
    if found.accepted:
        return "ambiguous" if any(len(one.alike) > 1 for one in found.accepted) else "effect_found"
    if steady is not None or found.cut_within_a_step:
        return "undecided"
    if settled.remains or found.withdrawn or settled.times > rules.far:
        return "unexplained"
    return "undecided" if refused or times_fitted > rules.far else "nothing_missing"


def _parameters_are_vague(settled: Settled, rules: Rules) -> bool:
    """Whether the error that is left is little only beside what the noise may have done to the parameters.

    Where they are so uncertain, an effect that is missing would not be seen beside them. If one fit to all
    horizons leaves no more than the noise, they are certain enough.
    """
    rmse = settled.found.final.score.rmse
    return not settled.found.at_noise and settled.accuracy.times_the_least(rmse) > rules.far


def _refused(settled: Settled, rules: Rules) -> str:
    """The largest gain worth having that the last model was refused; empty if there is none.

    Noise and simulation leave ``1 / times`` of the error. A gain that would take more than the rest took a
    part of the noise or of the simulation's error, and tells nothing of the machine. Nor does an effect whose
    amplitude is nothing.
    """
    found, most = settled.found, 1.0 - 1.0 / settled.times
    tried = found.steps[-1].trials if found.steps and found.steps[-1].accepted is None else ()
    gains = [
        *((t.gain, f"{t.candidate.name}, refused: {t.reason}") for t in tried if not is_nothing(t)),
        *((c.gain, f"{c.described}, p = {c.p_value:.2g}") for c in settled.left),
    ]
    possible = [(gain, what) for gain, what in gains if rules.worth <= gain <= most]
    if not possible:
        return ""
    gain, what = max(possible)
    return f"{gain:.1%} with {what}"
