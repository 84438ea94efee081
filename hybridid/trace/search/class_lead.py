"""Which member of a class leads it, asked again where nothing more is sought, as at the noise.

The members of a class cannot be told apart beside the model of their step. Beside what was accepted later
they may: a complete model leaves the noise alone, and a wrong member leaves a misfit. It may be small, but
the other parameters bend to it by many standard errors. So each other member takes the place of the accepted
one in the last model. If one then leaves less error by ``Rules.tie``, significantly with all of them counted,
and less on the fitted horizons as well, it leads its class, and the search goes on from there.

Source: sequential replacement; Miller (2002), Subset Selection in Regression, 2nd ed., Chapman & Hall, ch. 3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.search.steps import Accepted, Back, Step, back_at
from hybridid.trace.trials.exchange import exchanged
from hybridid.trace.trials.robustness import objection, survivals_of
from hybridid.trace.trials.trial import Trial


def led_by_the_better(steps: Sequence[Step], last: Refit, asked: set[int], context: Context) -> Back | None:
    """The steps up to one whose class another member leads in the model ``last``, with that one accepted, its
    model there and what that holds; None if there is none. Each step is ``asked`` once, by its number."""
    present = {term.name for term in last.model.terms}
    rivals = [
        (number, step.accepted, rival)
        for number, step in enumerate(steps[:-1])
        if number not in asked and step.accepted and not step.together and step.accepted.name in present
        for rival in step.accepted.alike
        if rival is not step.accepted.trial and rival.refit and rival.candidate.name not in present
    ]
    asked |= {number for number, _, _ in rivals}
    given = [
        (last, one.name, rival.candidate, context.split, rival.refit and rival.refit.values)
        for _, one, rival in rivals
    ]
    others = context.each("another member of a class in its place", exchanged, given)
    better = [
        (other.cost, number, rival)
        for (number, _, rival), other in zip(rivals, others, strict=True)
        if other is not None and _leaves_less(other, last, len(rivals), context)
    ]
    for _, number, rival in sorted(better, key=lambda one: one[0]):
        if (led := _led_by(rival, steps[number], context)) is not None:
            context.say(f"with {rival.candidate.name} less error is left: back to step {number + 1}")
            return back_at([*steps[:number], led])
    return None


def _leaves_less(other: Refit, last: Refit, counted: int, context: Context) -> bool:
    """Whether ``other``, one of so many, explains more than ``last``, fitted and held out. That says nothing
    if the fit of ``last`` has not converged."""
    advantage = compare(last.score, other.score)
    significant = counted * advantage.p_value <= context.rules.alpha
    better = advantage.gain >= context.rules.tie and significant and other.cost < last.cost
    return better and last.converged


def _led_by(rival: Trial, step: Step, context: Context) -> Step | None:
    """``step`` with ``rival`` leading the class that it accepted; None if another way to solve the equations
    takes its gain away."""
    assert step.accepted is not None
    survivals = survivals_of(step.base, rival, context, {})
    if objection(survivals):
        return None
    alike = (rival, *(t for t in step.accepted.alike if t is not rival))
    return replace(step, accepted=Accepted(rival, alike, survivals))
