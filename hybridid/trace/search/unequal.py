"""An effect at ports alike, with an amount of its own at each: alike need not be equal.

Both dampers of a vehicle may be asymmetric, and the rear one more. One set of parameters at both then leaves
an error that any other effect could take. So where an effect is accepted at two ports alike, the pair of it
at either port is judged as any pair is. It takes the place of the one at both if it explains more than that:
by what an effect must take, and significantly. The class of each member holds the effects of the class that
it had at both.
"""

from __future__ import annotations

from dataclasses import replace

from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.search.pair_decision import pair_taken
from hybridid.trace.search.steps import Step
from hybridid.trace.trials.cross_fitting import pairs_cross_fitted
from hybridid.trace.trials.pair import attempt_pair, judge_pairs, values_of
from hybridid.trace.trials.promise import Promise
from hybridid.trace.trials.trial import PASSED, Trial


def each_with_its_own(step: Step, context: Context) -> Step:
    """``step`` with the pair of the accepted effect at each of two ports alike, if that explains more."""
    one, base, rules = step.accepted, step.base, context.rules
    if one is None or step.together or one.trial.refit is None or not _is_at_two_alike(one.trial.candidate):
        return step
    promise = _at_each(one.trial, one.trial.refit)
    alone = {t.candidate.name: t for t in step.trials}
    singles = alone.get(promise.first.name), alone.get(promise.second.name)
    pair = context.one(attempt_pair, promise, singles, base, context.split, rules)
    if pair.refit is None:
        return step
    better = compare(one.trial.refit.score, pair.refit.score)
    if not rules.passes(better.gain, better.p_value):
        return step
    family = len(context.candidates(base.model))
    judged = pairs_cross_fitted(judge_pairs([pair], family, rules), base, family, context)
    if judged[0].status != PASSED:
        return step
    among = {t.candidate.effect.id for t in one.alike}
    taken = pair_taken(replace(step, accepted=None, family=family), judged, context, among)
    return taken if taken.accepted else step


def _is_at_two_alike(candidate: Candidate) -> bool:
    """Whether the effect acts at two ports alike. One that leads from a port into another is no such one."""
    return len(candidate.ports) == 2 and not candidate.effect.into


def _at_each(joint: Trial, fitted: Refit) -> Promise:
    """The effect of ``joint`` at each of its ports, as a pair that begins where both are ``fitted`` alike."""
    first, second = (Candidate(joint.candidate.effect, port) for port in joint.candidate.ports)
    own = values_of(fitted, joint.candidate)
    others = {name: value for name, value in fitted.values.items() if name not in own}
    short = {name.rsplit(".", 1)[-1]: value for name, value in own.items()}
    at_first, at_second = ({f"{c.name}.{name}": v for name, v in short.items()} for c in (first, second))
    return Promise(first, second, ({**others, **at_first}, at_second), joint.fitted_gain)
