"""Effects that only stand in for something that the library does not hold.

What acts like no effect of the library is still like some effect more than like others, and that one
would be accepted: an eddy-current brake passes for negative drag. Its name is trusted if a learned
effort finds little more than it did. With L the held-out loss before an effect, after it (and all later
ones), and after a learned effort beside these,

    share = (L_after^2 - L_learned^2) / ((L_before^2 - L_own^2) + (L_after^2 - L_learned^2)),

L_own being the loss right after it was accepted. A share above ``Rules.stands_in`` may also mean that the
machine lacks two things. So the effect is taken out from beside the learned effort: of what it took alone it
must still take ``Rules.kept``, or the learned effort can do without it. Then it is withdrawn, and what was
accepted after it. (What a learned effort takes must outlive other numerics: friction that sticks, smoothed,
leaves an error over velocity that is nobody's.)

Several effects together may hide so much that nothing is left to find beside them. So they are also held
against one learned effort in their place: if that alone takes more from the squared error, by a share above
``Rules.stands_in``, they are withdrawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hybridid.trace.ceiling import Ceiling
from hybridid.trace.context import Context
from hybridid.trace.evidence import compare
from hybridid.trace.refit import refit_if_possible
from hybridid.trace.robustness import surviving
from hybridid.trace.rules import Rules
from hybridid.trace.search import Accepted, Search, Step, values_without
from hybridid.trace.split import Split
from hybridid.trace.trial import REJECTED


def without_stand_ins(found: Search, ceilings: Sequence[Ceiling], context: Context) -> Search:
    """``found`` less the first effect that stands in for another, and those after it.

    A learned effort whose gain other numerics take away (friction that sticks, smoothed) accuses nobody.
    """
    split, rules = context.split, context.rules
    significant = [c for c in ceilings if c.p_value <= rules.alpha and c.gain > 0]
    for learned in sorted(significant, key=lambda c: -c.gain):
        accused = _accused(found, learned, split, rules)
        if accused is None:
            return found
        if surviving([learned.refit], found.final, context):
            return _ended_at(found, *accused)
    return found


def _accused(found: Search, learned: Ceiling, split: Split, rules: Rules) -> tuple[int, str] | None:
    """The step whose effect a learned effort shows to stand in for another, and how."""
    takes = found.final.score.loss**2 - learned.refit.score.loss**2
    kept = {one.name for one in found.accepted}
    for number, step in enumerate(found.steps):
        if step.accepted is None or step.accepted.name not in kept:
            continue
        share = takes / (step.accepted.trial.taken + takes)
        if share > rules.stands_in and not _needed(step.accepted, learned, split, rules):
            return number, (
                f"beside it a learned effort at {learned.place} still takes {share:.0%} of what both take "
                "from the squared error"
            )
    return None


def unless_outdone(found: Search, before: Sequence[Ceiling], rules: Rules) -> Search:
    """``found`` without its effects if one of ``before``, learned efforts beside the declared model, does
    better than all of them."""
    if not before:
        return found
    declared, named = (r.score.loss**2 for r in (found.steps[0].base, found.final))
    for one in sorted(before, key=lambda c: -c.gain):
        learned = one.refit.score.loss**2
        outdone = named - learned > rules.stands_in * (declared - learned)
        if outdone and compare(found.final.score, one.refit.score).p_value <= rules.alpha:
            return _ended_at(
                found,
                0,
                f"a learned effort at {one.place} alone takes {1 - learned / declared:.1%} "
                f"of the squared error, all effects accepted take {1 - named / declared:.1%}",
            )
    return found


def _needed(one: Accepted, learned: Ceiling, split: Split, rules: Rules) -> bool:
    """Whether the effect still takes its part beside the learned effort."""
    both = learned.refit
    alone = refit_if_possible(
        both.model.without(one.name), split, [values_without(both, one.name)], both, both.numerics
    )
    return alone is None or alone.score.loss**2 - both.score.loss**2 >= rules.kept * one.trial.taken


def _ended_at(found: Search, number: int, why: str) -> Search:
    """The search as if the step ``number`` had found nothing."""
    step = found.steps[number]
    assert step.accepted is not None
    name, reason = step.accepted.name, f"stands in for something else: {why}"
    trials = tuple(
        replace(t, status=REJECTED, reason=reason) if t.candidate.name == name else t for t in step.trials
    )
    ended: Step = replace(step, trials=trials, accepted=None)
    kept = tuple(one for one in found.accepted if one.name in {t.name for t in step.base.model.terms})
    return replace(
        found,
        steps=(*found.steps[:number], ended),
        final=step.base,
        accepted=kept,
        stopped=f"{name} {reason}",
    )
