"""Looks again, in the last model, at what each accepted effect cannot be told from.

A forward search judges an effect beside the model of its step. What is accepted or taken out later changes
that model, and with it the answer:

- later effects may tell apart what could not be told apart before, so every rival takes the accepted effect's
  place once more;
- sign(v) may have been smoothed more narrowly since. So what took nearly as much in that step takes its
  place, too: the wider smoothing may have decided between them;
- an effect of that step's model may have been taken out since. Then all trials of the step were judged beside
  a model that has been discarded since. So those that passed in any step are tried in the accepted one's
  place.

Source: sequential replacement; Miller (2002), Subset Selection in Regression, 2nd ed., Chapman & Hall, ch. 3.
"""

from __future__ import annotations

from dataclasses import replace

from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import values_without
from hybridid.trace.search.refuted import without_refuted
from hybridid.trace.search.steps import Accepted, Search
from hybridid.trace.trials.alike import equivalents
from hybridid.trace.trials.exchange import still_alike
from hybridid.trace.trials.judgement import judge
from hybridid.trace.trials.trial import PASSED, Trial
from hybridid.trace.trials.tried import tried_in_place

NEARLY = 0.9
"""Of what the accepted effect took, that a rival took which a wider smoothing may have kept out."""


def recheck(found: Search, context: Context) -> Search:
    """``found`` with the classes of its accepted effects as its last model shows them."""
    kept = _with_those_alike(found, context)
    every = replace(kept, accepted=tuple(_with_passed_before(kept, one, context) for one in kept.accepted))
    return without_refuted(every, context)


def _with_those_alike(found: Search, context: Context) -> Search:
    """Every rival takes the accepted effect's place; one that then explains less is not in the class."""
    rivals = [
        (one, rival)
        for one in found.accepted
        for rival in (*one.alike, *_kept_out(found, one))
        if rival is not one.trial
    ]
    at_noise = context.meets_noise(found.final.score)
    given = [(found.final, one.trial, rival, context.split, context.rules, at_noise) for one, rival in rivals]
    told = context.each("in place of what was accepted", still_alike, given)
    alike = [pair for pair, is_so in zip(rivals, told, strict=True) if is_so]
    classes = [(one.trial, *(rival for of, rival in alike if of is one)) for one in found.accepted]
    kept = (replace(one, alike=its) for one, its in zip(found.accepted, classes, strict=True))
    return replace(found, accepted=tuple(kept))


def _kept_out(found: Search, one: Accepted) -> list[Trial]:
    """What passed in the step of ``one``, took nearly as much and is not in its class, if sign(v) is smoothed
    more narrowly in the last model."""
    known = {t.candidate.name for t in one.alike}
    return [
        t
        for step in found.steps
        if any(other.name == one.name for other in step.taken)
        and step.base.model.adjustments != found.final.model.adjustments
        for t in step.trials
        if t.status == PASSED and t.taken >= NEARLY * one.trial.taken and t.candidate.name not in known
    ]


def _with_passed_before(found: Search, one: Accepted, context: Context) -> Accepted:
    """``one`` with those that do as well in its place, if it was judged beside an effect that is gone.

    Held-out horizons chose which are tried, so p counts all that the first step tried.
    """
    rivals = _passed_before(found, one, context) if _judged_beside_others(found, one) else []
    if not rivals:
        return one
    rules, final = context.rules, found.final
    model, values = final.model.without(one.name), values_without(final, one.name)
    poorer = context.one(refit_if_possible, model, context.split, [values], final, final.numerics)
    if poorer is None:
        return one
    here = replace(one.trial, refit=final, comparison=compare(poorer.score, final.score))
    trials = tried_in_place(one.name, rivals, poorer, final, context)
    judged = judge(trials, rules, len(found.steps[0].trials))
    _, *as_good = equivalents(here, judged, rules, context.meets_noise(final.score))
    return replace(one, alike=(*one.alike, *as_good))


def _judged_beside_others(found: Search, one: Accepted) -> bool:
    """Whether the model that ``one`` was judged beside held an effect that the last model lacks."""
    left = {term.name for term in found.final.model.terms}
    judged = [step for step in found.steps if any(other.name == one.name for other in step.taken)]
    if not judged:
        return False
    beside = {term.name for term in judged[-1].base.model.terms}
    return not beside | {other.name for other in judged[-1].taken} <= left


def _passed_before(found: Search, one: Accepted, context: Context) -> list[Candidate]:
    """What passed in any step and could take the place of ``one``, each once."""
    passed = {t.candidate.name for step in found.steps for t in step.trials if t.status == PASSED}
    wanted = passed - {t.candidate.name for t in one.alike}
    possible = context.candidates(found.final.model.without(one.name))
    return [candidate for candidate in possible if candidate.name in wanted]
