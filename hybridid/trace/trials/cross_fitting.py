"""Where few horizons judge, those that were fitted judge as well, by a fit to the others.

A test on n horizons cannot tell much: if all agree, the p-value of their signs is 2^-n, and all effects that
were tried share it. So each model is fitted once more, to the horizons that judge, and judged on those that
were fitted. The horizons of both sides together are twice as many, and none judges a model that was fitted to
it.

The two sides are not independent: the noise s_a of one side makes the parameter that the other one judges,
and the other way round. With an effect of one parameter that is nothing, and as many horizons on either side,
the log-likelihood ratios of both sides add up to

    2 s_a s_b - (s_a^2 + s_b^2) / 2,    s_a, s_b standard normal,

which is -1 on average, and (s_a^2 + s_b^2) / 2 at most. In the units of its own scatter it exceeds z with a
probability of less than exp(-2 z^2). So the test errs less often than its level.

Both tests are asked, this one and that of the horizons that judge alone. The smaller p-value counts, twice.

Source: Wasserman, Ramdas, Balakrishnan (2020), Universal inference, Proc. Natl. Acad. Sci. 117(29),
16880-16890 (the cross-fit likelihood ratio).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.score import Score
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.trials.judgement import decided_at
from hybridid.trace.trials.pair import PairTrial, decided_pair
from hybridid.trace.trials.trial import Trial

FEW = 24
"""Horizons that judge, below which the others do as well. Of so many an eighth may disagree: the p-value of
their signs, 1.4e-4, is then still below the 2e-4 that one of fifty effects needs at the level of 1 %."""
TESTS = 2
"""The horizons that judge alone, and both sides."""


def cross_fitted(judged: Sequence[Trial], base: Refit, context: Context, family: int = 0) -> list[Trial]:
    """The ``judged`` trials beside ``base``, decided by both tests where fewer than ``FEW`` horizons judge.

    Only those are fitted to the other side that the first test leaves open. All of the ``family`` count, or
    all that were judged.
    """
    open_ = [t for t in judged if _is_open(t.gain, t.p_adjusted, t.refit, context)]
    models = {t.candidate.name: [base, t.refit] for t in open_ if t.refit}
    p_values = _of_both_sides(models, family or len(judged), context)
    return [
        decided_at(t, _smaller(p_values[t.candidate.name], t.p_adjusted), context.rules)
        if t.candidate.name in p_values
        else t
        for t in judged
    ]


def pairs_cross_fitted(
    judged: Sequence[PairTrial], base: Refit, family: int, context: Context
) -> list[PairTrial]:
    """As ``cross_fitted``, of pairs of effects: both against neither, and each beside the other."""
    open_ = [
        pair
        for pair in judged
        if _is_open(min([pair.gain, *(m.gain for m in pair.members)]), pair.p_adjusted, pair.refit, context)
    ]
    models = {pair.name: [base, *pair.alone, pair.refit] for pair in open_ if pair.refit}
    p_values = _of_both_sides(models, family, context)
    return [
        decided_pair(pair, _smaller(p_values[pair.name], pair.p_adjusted), context.rules)
        if pair.name in p_values
        else pair
        for pair in judged
    ]


def _smaller(one: float, other: float) -> float:
    """The smaller of the p-values of both tests, which counts twice."""
    return min(1.0, TESTS * min(one, other))


def _is_open(gain: float, p_adjusted: float, fitted: Refit | None, context: Context) -> bool:
    """Whether the other side is asked: few horizons judge, and they leave open a gain worth having of a refit
    that was carried to the end."""
    few = len(context.split.held_out) < FEW
    unsure = gain >= context.rules.worth and TESTS * p_adjusted > context.rules.alpha
    return few and unsure and fitted is not None and not fitted.ended_early


def _of_both_sides(models: Mapping[str, Sequence[Refit]], family: int, context: Context) -> dict[str, float]:
    """The p-values, by name, of the last of the ``models`` over each of those before it: the largest one,
    with the horizons of both sides, ``family`` times. None where a fit to the other side has not converged:
    of a poorer model, what it leaves too much would count for the effect."""
    every = list({id(one): one for several in models.values() for one in several}.values())
    given = [_swapped(one, context) for one in every]
    swapped = context.each("fitted to the other horizons", refit_if_possible, given)
    scores = {
        id(one): joined(one.score, other.score)
        for one, other in zip(every, swapped, strict=True)
        if other is not None and other.converged
    }
    return {
        name: family * max(compare(scores[id(one)], scores[id(richer)]).p_value for one in poorer)
        for name, (*poorer, richer) in models.items()
        if all(id(one) in scores for one in (*poorer, richer))
    }


def joined(one: Score, other: Score) -> Score:
    """The score of a model on the horizons of two sides, each fitted to the other one."""
    rows = ("squares", "samples", "block_squares", "block_samples", "likelihood")
    both = {name: np.concatenate([getattr(one, name), getattr(other, name)]) for name in rows}
    return replace(one, innovation=np.maximum(one.innovation, other.innovation), **both)


def _swapped(fitted: Refit, context: Context) -> tuple[object, ...]:
    return fitted.model, context.split.swapped, [fitted.values], fitted, fitted.numerics
