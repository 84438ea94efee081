"""Which trials explain the records equally well, and which effects are physically related."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hybridid.effects.composed import is_composed
from hybridid.estimators.floor import MISFIT
from hybridid.trace.horizons.evidence import Comparison, compare
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.trials.judgement import undetermined
from hybridid.trace.trials.trial import PASSED, REJECTED, Trial

USUAL = 0.05
"""Level of a test of one difference alone. Eight horizons that all agree reach no p-value below 0.01, but are
enough to show that one effect leaves several times the error of another."""
ROUNDING = 1e-9
"""Share of an error that the arithmetic may change."""


def equivalents(best: Trial, trials: Sequence[Trial], rules: Rules, at_noise: bool = False) -> list[Trial]:
    """The trials that held-out horizons cannot tell from ``best``, itself first. ``at_noise``: it leaves no
    more than the noise.

    Beside those that passed, these are the determined ones whose gain alone is not significant, if they take
    at least half of what ``best`` takes: not to be shown better than nothing is not to be shown worse than
    ``best``. (Hansen, Lunde, Nason (2011), The model confidence set, Econometrica 79(2), 453-497.)

    Two effects are one class if the advantage of the better one is not significant, or less than
    ``rules.tie`` of the error of each output. Declared look-alikes are one class also if it is less than
    ``rules.tie`` of what the better one takes from the squared error, and the other one leaves no more than
    ``rules.far`` times its error in each output, or ``MISFIT`` times where that is the noise. (Bouc-Wen
    hysteresis contains Dahl's friction and has one shape parameter more, which always lowers the error a
    little. But where most of what the other one leaves is its own misfit, the records refute it.)
    """
    others = [t for t in trials if t is not best and (t.status == PASSED or _insignificant(t, best, rules))]
    return [
        best,
        *(t for t in others if indistinguishable(best, t, rules) or _nearly_alike(best, t, rules, at_noise)),
    ]


def _insignificant(trial: Trial, best: Trial, rules: Rules) -> bool:
    """Whether only significance refused the trial, which takes at least half of what ``best`` takes. A trial
    of which no standard errors were asked for is not known to be determined."""
    only = trial.status == REJECTED and trial.gain >= rules.worth and trial.p_adjusted > rules.alpha
    if not only or 2 * trial.taken < best.taken or trial.refit is None or not trial.refit.std:
        return False
    return not (trial.not_shown or undetermined(trial, rules))


def _nearly_alike(best: Trial, other: Trial, rules: Rules, at_noise: bool) -> bool:
    left, more = 1.0 - best.gain, 1.0 - other.gain
    near = more**2 - left**2 < rules.tie * (1.0 - left**2) and more <= _most_left(rules, at_noise) * left
    if not near or best.refit is None or other.refit is None or not look_alikes(best, other):
        return False
    return leaves_little_more(other.refit, best.refit, rules, at_noise)


def leaves_little_more(other: Refit, best: Refit, rules: Rules, at_noise: bool) -> bool:
    """Whether ``other`` leaves at most ``rules.far`` times the error of ``best`` in each output; ``MISFIT``
    times where that is the noise."""
    most = (1 + ROUNDING) * _most_left(rules, at_noise)
    return bool(np.all(other.score.rmse <= most * best.score.rmse))


def _most_left(rules: Rules, at_noise: bool) -> float:
    return MISFIT if at_noise else rules.far


def look_alikes(one: Trial, other: Trial) -> bool:
    """Whether one effect is declared to look like the other."""
    ours, theirs = one.candidate.effect, other.candidate.effect
    return ours.id in theirs.look_alikes or theirs.id in ours.look_alikes


def related(one: Trial, other: Trial) -> bool:
    """Whether both are the same law, perhaps at several ports, or declared look-alikes."""
    return one.candidate.effect.id == other.candidate.effect.id or look_alikes(one, other)


def strangers(one: Trial, alike: Sequence[Trial]) -> list[Trial]:
    """The members of the class ``alike`` that no chain of look-alikes joins to ``one``.

    A composed law claims nothing physical, and neither do the laws that do as well.
    """
    if is_composed(one.candidate.effect):
        return []
    joined, left = [one], [t for t in alike if t is not one]
    while near := [t for t in left if any(related(t, other) for other in joined)]:
        joined += near
        left = [t for t in left if t not in near]
    return left


def indistinguishable(best: Trial, other: Trial, rules: Rules) -> bool:
    """Whether held-out horizons show no relevant advantage of ``best``."""
    assert best.refit is not None
    assert other.refit is not None
    return not tells_apart(compare(other.refit.score, best.refit.score), rules)


def tells_apart(advantage: Comparison, rules: Rules) -> bool:
    """Whether the ``advantage`` of one effect over another is relevant, over all outputs or in one of them,
    and significant: at ``rules.alpha``, or at ``USUAL`` where the other one leaves more than ``rules.far``
    times the error."""
    level = max(rules.alpha, USUAL) if advantage.gain > 1.0 - 1.0 / rules.far else rules.alpha
    relevant = advantage.gain >= rules.tie or (advantage.gain > 0 and advantage.largest >= rules.tie)
    return relevant and advantage.p_value <= level
