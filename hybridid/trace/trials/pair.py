"""``PairTrial``: two candidates, refitted together and judged.

A pair claims more than one effect does, so three comparisons must pass: the model with both against the
model with neither, and against the model with each of the two alone. The last two say that each is needed
beside the other. The null hypothesis is that one of the three gains is none, so the largest of the three
p-values counts (intersection-union test: Berger (1982), Technometrics 24(4), 295-300). All pairs that could
be formed count, tried or not: p is multiplied by their number (Bonferroni).
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from hybridid.quantities import change, percent
from hybridid.trace.candidates import Candidate, each_once
from hybridid.trace.horizons.evidence import Comparison, compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.numerics import Numerics
from hybridid.trace.refits.refit import least_of, refit_beside, refit_if_possible
from hybridid.trace.refits.refitted import Refit, values_without
from hybridid.trace.rules import Rules
from hybridid.trace.starts.shown import not_shown
from hybridid.trace.starts.solve import by_either_integrator
from hybridid.trace.trials.judgement import NOT_SIGNIFICANT, too_little, undetermined
from hybridid.trace.trials.promise import Promise
from hybridid.trace.trials.trial import PASSED, REJECTED, UNIDENTIFIABLE, UNTRIED, Trial

Values = Mapping[str, float]


@dataclass(frozen=True)
class PairTrial:
    """Two candidates with the refit of both, its evidence over the model without them, and the decision.

    ``members`` are the trials of each beside the other, ``alone`` the refits with the other one only: what
    each trial is compared with. There are none where the pair could not be fitted or gains too little.
    ``promised`` is the share by which the pair was chosen.
    """

    candidates: tuple[Candidate, Candidate]
    promised: float
    refit: Refit | None
    comparison: Comparison | None = None
    members: tuple[Trial, ...] = ()
    alone: tuple[Refit, ...] = ()
    p_adjusted: float = 1.0
    status: str = REJECTED
    reason: str = ""
    failure: str = ""
    seconds: float = 0.0

    @property
    def name(self) -> str:
        """``port.effect + port.effect``."""
        return " + ".join(candidate.name for candidate in self.candidates)

    @property
    def gain(self) -> float:
        """Relative decrease of the held-out loss by both; minus infinity without a comparison."""
        return self.comparison.gain if self.comparison else -math.inf

    @property
    def p_value(self) -> float:
        """The largest p-value of the comparisons that must pass, not adjusted."""
        made = [self.comparison, *(member.comparison for member in self.members)]
        return max((one.p_value for one in made if one is not None), default=1.0)


@np.errstate(over="ignore", invalid="ignore")  # a start may diverge
def attempt_pair(
    promise: Promise,
    singles: tuple[Trial | None, Trial | None],
    base: Refit,
    split: Split,
    rules: Rules,
    rival: Refit | None = None,
) -> PairTrial:
    """Add both candidates to the base model, refit everything, compare on held-out horizons.

    Each starts as it promised most, and where its trial of ``singles`` ended, in every combination. The refit
    ends early if it promises too little over the base model or, if there is one, over its ``rival``, which it
    must beat by ``Rules.tie``.
    """
    began = time.perf_counter()
    starts = _starts(promise, singles, base)
    least = least_of(rules.worth if rival is None else min(rules.worth, rules.tie))

    def solve(numerics: Numerics, to_beat: Refit, chosen: Sequence[int] | None) -> PairTrial:
        own = starts if chosen is None else [starts[k] for k in chosen]
        lowest = min(filter(None, (to_beat, rival)), key=lambda one: one.cost)
        return _solved(promise, own, base, split, numerics, lowest, least)

    trial = by_either_integrator(solve, base)
    if trial.gain >= rules.worth and trial.refit is not None and not trial.refit.ended_early:
        trial = _beside_each_other(trial, singles, split)
    return replace(trial, seconds=time.perf_counter() - began)


def _starts(
    promise: Promise, singles: tuple[Trial | None, Trial | None], base: Refit
) -> list[dict[str, float]]:
    """Starts of both together: every combination of the starts of each, none twice."""
    each: list[list[Values]] = []
    for start, single in zip(promise.starts, singles, strict=True):
        ended = [values_of(single.refit, single.candidate)] if single is not None and single.refit else []
        each.append([start, *ended])
    return each_once([{**base.values, **one, **other} for one, other in product(*each)])


def values_of(refitted: Refit, candidate: Candidate) -> dict[str, float]:
    """The values in ``refitted`` of the parameters of ``candidate`` alone."""
    return {n: v for n, v in refitted.values.items() if n.startswith(f"{candidate.name}.")}


def _solved(
    promise: Promise,
    starts: Sequence[Values],
    base: Refit,
    split: Split,
    numerics: Numerics,
    to_beat: Refit,
    least: float,
) -> PairTrial:
    pair = (promise.first, promise.second)
    model = promise.second.added_to(promise.first.added_to(base.model))
    try:
        found = refit_beside(base, model, split, starts, numerics, to_beat, least)
    except (ValueError, ArithmeticError) as error:
        return PairTrial(pair, promise.share, None, failure=str(error))
    if not math.isfinite(found.cost):
        return PairTrial(pair, promise.share, None, failure="the simulation diverges from every start")
    return PairTrial(pair, promise.share, found, compare(base.score, found.score))


def _beside_each_other(pair: PairTrial, singles: Sequence[Trial | None], split: Split) -> PairTrial:
    """``pair`` with the trial of each member beside the other one."""
    assert pair.refit is not None
    both, members, alone = pair.refit, [], []
    for member, other, single in zip(pair.candidates, pair.candidates[::-1], singles[::-1], strict=True):
        values = values_without(both, member.name)
        starts = [values]
        if single is not None and single.refit is not None:
            starts.append({**values, **values_of(single.refit, other)})
        poorer = refit_if_possible(
            both.model.without(member.name), split, starts, both, both.numerics, math.inf
        )
        if poorer is None:
            return replace(pair, failure=f"the model without {member.name} cannot be simulated")
        evidence = compare(poorer.score, both.score)
        share = max(0.0, 1.0 - both.cost / poorer.cost) if poorer.cost > 0 else 0.0
        members.append(Trial(member, both, evidence, share, not_shown=not_shown(member, both, split)))
        alone.append(poorer)
    return replace(pair, members=tuple(members), alone=tuple(alone))


def judge_pairs(pairs: Sequence[PairTrial], family: int, rules: Rules) -> list[PairTrial]:
    """Give every pair its status and reason; all of the ``family`` count."""
    return [decided_pair(pair, min(1.0, family * pair.p_value), rules) for pair in pairs]


def decided_pair(pair: PairTrial, p: float, rules: Rules) -> PairTrial:
    """``pair`` with its status and reason, where ``p`` is its adjusted p-value."""
    pair = replace(pair, p_adjusted=p)
    if pair.refit is None or (pair.failure and not pair.members):
        return replace(pair, status=UNTRIED, reason=f"could not be fitted: {pair.failure}")
    if pair.gain < rules.worth:
        ended = "; its refit promised little and ended early" if pair.refit.ended_early else ""
        return replace(pair, status=REJECTED, reason=f"{too_little(pair.gain, rules)}{ended}")
    if pair.refit.ended_early:
        return replace(pair, status=REJECTED, reason="its refit promised too little and ended early")
    members = tuple(
        replace(
            member,
            p_adjusted=p,
            status=PASSED,
            reason=f"beside {other.name} the held-out RMSE is {member.gain:.1%} lower, adjusted p = {p:.2g}",
        )
        for member, other in zip(pair.members, pair.candidates[::-1], strict=False)
    )
    pair = replace(pair, members=members)
    for member, other in zip(members, members[::-1], strict=True):
        if member.gain < rules.worth:
            said = (
                f"beside {other.candidate.name}, {member.candidate.name} changes the held-out RMSE by "
                f"{change(1.0, 1.0 - member.gain)}; {percent(rules.worth)} less is asked of each"
            )
            return replace(pair, status=REJECTED, reason=said)
    if p > rules.alpha:
        said = f"{NOT_SIGNIFICANT}: adjusted p = {p:.2g} over {rules.alpha:g}"
        return replace(pair, status=REJECTED, reason=said)
    for member in members:
        vague = member.not_shown or undetermined(member, rules)
        if vague:
            return replace(pair, status=UNIDENTIFIABLE, reason=f"{member.candidate.name}: {vague}")
    said = f"held-out RMSE {pair.gain:.1%} lower, adjusted p = {p:.2g}; each is needed beside the other"
    return replace(pair, status=PASSED, reason=said)
