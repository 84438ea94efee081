"""Effects that are minor beside a learned effort are not accepted.

A forward search takes the best effect of the library, even where the machine has something else that would
take far more of the error. The accepted effect then resembles a part of that, and further effects would be
accepted to fit the rest. So the best effect is compared with the learned efforts beside the same model. With
L the held-out loss,

    L_base^2 - L_effect^2 < majority (L_base^2 - L_learned^2)

says that the effect is minor. No learned effort takes more than all, so an effect that takes that share of
L_base^2 is not minor, and nothing need be learned. Of two effects that add up, the larger takes at least half
of what any curve can take; so a true effect is minor only where two help together and not alone. A learned
effort adds up all effects of its variable, so it says nothing against an effect that is itself a curve over
that variable. If the effect that takes most is minor, the step ends as if none had passed: a narrower
smoothing of sign(v) is tried next, then pairs, and then composed laws, beside which the search goes on. If it
is not, but the one that was preferred to it is, the step decides again among those that are not minor.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from hybridid.trace.context import Context
from hybridid.trace.learned.ceiling import Ceiling
from hybridid.trace.learned.law_curve import is_curve_over
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.trials.robustness import surviving
from hybridid.trace.trials.trial import Trial

MINOR = "minor: "
"""How the reason begins why an effect that had passed is refused for that."""


def may_be_minor(best: Trial, base: Refit, context: Context) -> bool:
    """Whether ``best`` leaves enough of the squared error, and more than the noise."""
    assert best.refit is not None
    noisy = context.meets_noise(best.refit.score)
    return not noisy and best.taken < context.rules.majority * base.score.loss**2


def minor_beside(
    tried: Sequence[Trial], base: Refit, learned: Sequence[Ceiling], context: Context
) -> dict[str, Ceiling]:
    """Those of ``tried`` that are minor, by name, each with the learned effort beside ``base`` that shows it.

    The gain of that must be worth having, significant, and survive other numerics. One does not count if the
    effect is a curve over the same variable: it may be one of several that the learned effort adds up.
    """
    rules, split = context.rules, context.split
    passed = sorted((c for c in learned if c.passes(rules)), key=lambda c: -c.taken(base))
    survives = cache(lambda k: bool(surviving([passed[k].refit], base, context)))

    def is_curve(trial: Trial, one: Ceiling) -> bool:
        name, ports, found = trial.candidate.name, trial.candidate.ports, trial.refit
        assert found is not None
        return one.port in ports and is_curve_over(found, name, one.port, one.over, split)

    def shown_by(trial: Trial) -> Ceiling | None:
        larger = [(k, c) for k, c in enumerate(passed) if trial.taken < rules.majority * c.taken(base)]
        return next((c for k, c in larger if not is_curve(trial, c) and survives(k)), None)

    found = {trial.candidate.name: shown_by(trial) for trial in tried}
    return {name: one for name, one in found.items() if one is not None}


def said_of_minor(best: Trial, base: Refit, learned: Ceiling) -> str:
    """Why ``best`` is no name, in words."""
    before = base.score.loss**2
    more = 1 - learned.refit.score.loss**2 / before
    return (
        f"it takes {best.taken / before:.0%} of the squared error, {learned.described} {more:.0%}: "
        "most of what is missing is something else"
    )
