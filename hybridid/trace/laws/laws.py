"""Laws that no effect of the library has: composed where a learned effort finds what no effect explains.

A learned effort says over which variable something is missing, and how much any law of that variable could
take. Every shape that textbooks use over that variable (``hybridid.effects.shapes``) is then an effect like
those of the library: it joins the model, all parameters are refitted in simulation, and the same rules judge
it. The learned efforts are held against the same horizons, so the p-values are adjusted for the whole family:
every shape over every variable that the ports have, tried or not.

The variables are taken in the order of what a law of each could take (``Ceiling.most``). One is left out if
that is nothing, or less than ``1 - Rules.stands_in`` of what the best law takes already: no law of that
variable can take more, up to the resolution of the learned effort's grid. A sine of short period is finer
than the grid, and so is a contact that the machine hardly presses in: these are tried all the same.

Where the best law does not reach the noise, its amplitude may depend on another variable: such laws are tried
as well, beside the same model (``hybridid.trace.laws.law_levels``).

A formula claims the form. So a law is refused if the learned effort over its own variable takes more of the
squared error, significantly, and the law less than ``1 - Rules.stands_in`` of that: its form is another one.

Of laws that the held-out horizons cannot tell apart, the one with the fewest parameters is proposed; the
others are told beside it. Effects that the law has made needless are removed again.

An effect may resemble an unknown law, and others may mend what it leaves. So where effects were accepted,
laws are tried in their place as well: those of every variable where a learned effort beside the declared
model leaves less than all of them, else those that may be finer than it. One that alone explains more, by
more than ``Rules.tie`` and significantly, takes their place: as ``hybridid.trace.search.pairs`` does it with
pairs. Several effects are parts of one curve where a learned effort over one variable takes as much as all of
them. There a law takes their place that is not shown to explain less, with fewer parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import takewhile

from hybridid.effects.composed import ComposedLaw, composed
from hybridid.effects.shapes import Shape, shapes_over
from hybridid.naming import counted, listed
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.laws.law_levels import WithLevel, products_over, with_levels
from hybridid.trace.laws.law_starts import law_starts
from hybridid.trace.laws.level_curve import level_over_freed
from hybridid.trace.learned.ceiling import Ceiling
from hybridid.trace.learned.law_curve import LawOverLearned, law_over_learned
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.search import decided, without_needless
from hybridid.trace.search.steps import Search, said_of
from hybridid.trace.trials.alike import tells_apart
from hybridid.trace.trials.cross_fitting import cross_fitted
from hybridid.trace.trials.judgement import judge
from hybridid.trace.trials.trial import PASSED, REJECTED, Trial, attempt


def with_law(
    found: Search,
    left: Sequence[Ceiling],
    context: Context,
    rival: Refit | None = None,
    finer: bool = False,
    formed: int = 0,
) -> Search:
    """``found`` with the law that explains best what the learned efforts ``left`` still find, or with those
    that were refused if none passes. Refits end early that do not beat the ``rival``, if there is one; with
    ``finer`` only laws are tried that may be finer than a learned effort. ``formed`` laws count, at least
    those over ``left``."""
    base, rules = found.final, context.rules
    laws = _tried(found, left, context, rival, finer)
    if not laws:
        return found
    levelled, more = with_levels(base, laws, left, context)
    trials, family = [*laws, *(one.trial for one in levelled)], max(family_of(left), formed) + more
    both_sides = cross_fitted(judge(trials, rules, family), base, context, family)
    judged = [_unless_short(trial, base, left, rules) for trial in both_sides]
    step = decided(base, judged, context)
    context.say(f"of {family} laws, {len(trials)} tried: {said_of(step)}")
    law = step.accepted
    if law is None or law.trial.refit is None:
        return replace(found, refused_laws=step.trials, laws_formed=family)
    with_it = law.trial.refit
    law = replace(law, drawn=_drawn(base, law.trial, left, levelled, context.split))
    final, accepted, dropped = without_needless(with_it, [*found.accepted, law], context)
    return replace(
        found,
        steps=(*found.steps, replace(step, accepted=law, dropped=dropped)),
        final=final,
        accepted=tuple(accepted),
        withdrawn="",
    )


def _unless_short(law: Trial, base: Refit, left: Sequence[Ceiling], rules: Rules) -> Trial:
    """``law``, refused if it falls short of the learned effort over its own variable."""
    if law.status != PASSED or law.refit is None:
        return law
    for learned in (one for one in left if _same_place(one, law)):
        most = learned.taken(base)
        better = compare(law.refit.score, learned.refit.score)
        if law.taken < (1 - rules.stands_in) * most and better.p_value <= rules.alpha:
            squares = base.score.loss**2
            return replace(
                law,
                status=REJECTED,
                reason=f"another form: it takes {law.taken / squares:.0%} of the squared error, "
                f"{learned.described} {most / squares:.0%}",
            )
    return law


def _drawn(
    base: Refit, law: Trial, left: Sequence[Ceiling], levelled: Sequence[WithLevel], split: Split
) -> LawOverLearned:
    """The law over what it explains: a learned effort, or the freed amplitude of a law of one variable."""
    assert law.refit is not None
    for one in levelled:
        if one.trial.candidate == law.candidate:
            return level_over_freed(law, one.law, one.freed, split)
    (explained,) = (one for one in left if _same_place(one, law))
    return law_over_learned(base, law.refit, explained, split)


def _tried(
    found: Search, left: Sequence[Ceiling], context: Context, rival: Refit | None, finer: bool
) -> list[Trial]:
    """The refits of the laws over the variables of ``left``, in the order of what these take. First come
    those of which another law than a withdrawn name is known to explain more (``Search.other_laws``).

    A variable that is left out stays so, as the best law can only take more. So neighbours that are left out
    are tried together.
    """
    base, rules, trials = found.final, context.rules, list[Trial]()

    def is_known(one: Ceiling) -> bool:
        return (one.port, one.over) in found.other_laws

    waiting = [c for c in left if not c.failure]
    waiting.sort(key=lambda c: (not is_known(c), -c.most(base, rules)))
    while waiting:
        most = max((t.taken for t in trials), default=0.0)
        excluded = waiting if finer else _left_out(waiting, base, most, rules)
        excluded = [] if is_known(waiting[0]) else excluded
        now = excluded or waiting[:1]
        waiting = waiting[len(now) :]
        given = [
            (learned, shape, base, context.split, rules.worth, rival)
            for learned in now
            for shape in shapes_over(learned.over.variable)
            if shape.finer(learned.over) or not excluded
        ]
        more = f" and {counted(len(now) - 1, 'other place')}" if len(now) > 1 else ""
        stage = f"laws at {now[0].place}{more}"
        trials += context.each(stage, try_law, given, lambda t: t.candidate.name, always=0)
    return trials


def _left_out(waiting: Sequence[Ceiling], base: Refit, most: float, rules: Rules) -> list[Ceiling]:
    """The first ones of ``waiting``, up to one that finds something, and no less than the best law, which
    takes ``most``."""
    enough = (1 - rules.stands_in) * most

    def finds_too_little(one: Ceiling) -> bool:
        found = one.passes(rules) or one.untested(rules)
        return not found or one.most(base, rules) < enough

    return list(takewhile(finds_too_little, waiting))


def law_in_place(found: Search, before: Sequence[Ceiling], context: Context) -> Search:
    """The law that alone explains more than all that ``found`` accepted, or as much as several effects with
    fewer parameters, in their place; ``found`` itself if there is none. ``before`` are the learned efforts
    beside the declared model: where each of them explains less, only laws are tried that may be finer."""
    rules = context.rules
    names = listed([one.name for one in found.accepted])
    context.say(f"laws in place of {names}")
    if whole := _as_much_as_several(found, before, rules):
        lawful = with_law(found.before_any, whole, context, formed=family_of(before))
    else:
        enough = (1 - rules.tie) * found.final.score.loss
        finer = all(one.refit.score.loss > enough for one in before)
        lawful = with_law(found.before_any, before, context, found.final, finer)
    better = compare(found.final.score, lawful.final.score)
    family = family_of(before) + products_over(before, context)
    explains_more = better.gain >= rules.tie and family * better.p_value <= rules.alpha
    if explains_more or _is_simpler(lawful, found, rules):
        return replace(lawful, in_place_of=tuple(one.name for one in found.accepted))
    if lawful.accepted:
        context.say(f"the law does not explain more than {names}: no law takes that place")
    return found


def _as_much_as_several(found: Search, before: Sequence[Ceiling], rules: Rules) -> list[Ceiling]:
    """Of the learned efforts ``before``, those that take as much as all that ``found`` accepted, up to the
    resolution of their grid, if that is several effects."""
    taken = found.first.score.loss**2 - found.final.score.loss**2
    several = len(found.accepted) > 1
    return [one for one in before if several and one.taken(found.first) >= (1 - rules.stands_in) * taken]


def _is_simpler(lawful: Search, found: Search, rules: Rules) -> bool:
    """Whether ``lawful`` holds a law with fewer parameters than all that ``found`` accepted, and is not shown
    to explain less."""
    if not lawful.accepted or len(found.accepted) < 2:
        return False
    ours, theirs = (sum(one.trial.free_parameters for one in each.accepted) for each in (lawful, found))
    return ours < theirs and not tells_apart(compare(lawful.final.score, found.final.score), rules)


def family_of(learned: Sequence[Ceiling]) -> int:
    """The number of laws over the variables of the learned efforts, tried or not."""
    return sum(len(shapes_over(one.over.variable)) for one in learned)


def _same_place(learned: Ceiling, trial: Trial) -> bool:
    law = trial.candidate.effect.law
    return trial.candidate.port == learned.port and isinstance(law, ComposedLaw) and law.over == learned.over


def try_law(
    learned: Ceiling,
    shape: Shape,
    base: Refit,
    split: Split,
    worth: float = Rules.worth,
    rival: Refit | None = None,
) -> Trial:
    """Refit ``base`` with ``shape`` over the variable of a learned effort, in whose likeness it starts; see
    ``attempt`` for ``worth`` and ``rival``."""
    effect = composed(learned.over, shape, learned.kind, law_starts(learned, shape, base, split))
    return attempt(Candidate(effect, learned.port), base, split, worth, rival)
