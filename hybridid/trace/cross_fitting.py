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

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hybridid.trace.context import Context
from hybridid.trace.evidence import compare
from hybridid.trace.judgement import decided_at
from hybridid.trace.refit import Refit, refit_if_possible
from hybridid.trace.score import Score
from hybridid.trace.trial import Trial

FEW = 24
"""Horizons that judge, below which the others do as well. Of so many an eighth may disagree: the p-value of
their signs, 1.4e-4, is then still below the 2e-4 that one of fifty effects needs at the level of 1 %."""
TESTS = 2
"""The horizons that judge alone, and both sides."""


def cross_fitted(judged: Sequence[Trial], base: Refit, context: Context) -> list[Trial]:
    """The ``judged`` trials beside ``base``, decided by both tests where fewer than ``FEW`` horizons judge.

    Only those are fitted to the other side that the first test leaves open.
    """
    split, rules = context.split, context.rules
    if len(split.held_out) >= FEW:
        return list(judged)
    open_ = [t for t in judged if t.gain >= rules.worth and TESTS * t.p_adjusted > rules.alpha and _ended(t)]
    poorer = context.one(refit_if_possible, *_swapped(base, context)) if open_ else None
    if poorer is None or not poorer.converged:  # what it leaves would count for the effects
        return list(judged)
    richer = context.mapper(refit_if_possible, [_swapped(t.refit, context) for t in open_ if t.refit])
    before = joined(base.score, poorer.score)
    p_values = {
        t.candidate.name: len(judged) * compare(before, joined(t.refit.score, other.score)).p_value
        for t, other in zip(open_, richer, strict=True)
        if t.refit is not None and other is not None and other.converged
    }
    return [_decided(t, p_values, context) for t in judged]


def joined(one: Score, other: Score) -> Score:
    """The score of a model on the horizons of two sides, each fitted to the other one."""
    rows = ("squares", "samples", "block_squares", "block_samples", "likelihood")
    both = {name: np.concatenate([getattr(one, name), getattr(other, name)]) for name in rows}
    return replace(one, innovation=np.maximum(one.innovation, other.innovation), **both)


def _ended(trial: Trial) -> bool:
    """Whether its refit was carried to the end."""
    return trial.refit is not None and not trial.refit.ended_early


def _swapped(fitted: Refit, context: Context) -> tuple[object, ...]:
    return fitted.model, context.split.swapped, [fitted.values], fitted, fitted.numerics


def _decided(trial: Trial, p_values: dict[str, float], context: Context) -> Trial:
    p = p_values.get(trial.candidate.name)
    if p is None:
        return trial
    return decided_at(trial, min(1.0, TESTS * min(p, trial.p_adjusted)), context.rules)
