"""Whether others should replace a declared effect: each one is left out, and the search is repeated.

A search that only adds cannot replace. Where viscous friction is declared, and Coulomb friction and quadratic
drag are true, each of the two alone may gain nothing beside the viscous term; only the pair replaces it. Or
the search mends the viscous term with effects that the machine has not, until nothing is left to be gained.
Without the declared effect each of the two gains by itself, so the search finds them one after the other; or
as a pair, where another effect resembles both.
What such a search accepted gives way to effects of fewer parameters that are as good
(``hybridid.trace.search.simpler``). What the trace accepted may do without the declared effect as well. So
that is tried, too; accepted effects that are needless then are left out with it.

The model so found, the revised one, is held against the last one of the trace on held-out horizons. It passes

- if it explains the records ``better``, by the rules for any effect. Its p-value counts every trial of every
  step of every such search (Bonferroni).
- or if it explains them ``as_good``, with fewer free parameters. The last model then takes less than
  ``Rules.tie`` from its error, and not significantly. But not to be shown worse is not yet to be as good: so
  the log-likelihood of the last model may be larger by one at most for each parameter that it has more, the
  price that Akaike's criterion sets. (What costs no more in the likelihood of the plain errors either, is
  not worth a test: where an effect ends at zero, refits that end a little apart decide that.) And the revised
  model must be adequate itself, with at most ``Rules.far`` times the error of noise and simulation: two
  models that both lack something may be alike in that.

Where the last model meets the noise, nothing better can be found. So only models with fewer free parameters
are tried there. A declared effect of one parameter beside which nothing was accepted is not left out: what
takes its place has one parameter at least.

Of two models that the records cannot tell apart, the one with fewer parameters is preferred (parsimony).
Source: Ljung (1999), System Identification, 2nd ed., sec. 16.4; Akaike (1974), IEEE Trans. Autom. Control
19(6), 716-723; Altman, Bland (1995), BMJ 311, 485 (absence of evidence is not evidence of absence).

Neither doubts the declared effect yet. The search without it may merely have found what the other search
missed. So the declared effect

- must explain nothing more beside the revised model. Where that is only as good, the effect may neither be
  significant there on held-out horizons nor have an amplitude that differs significantly from zero (Wald).
- must not do in the place of one of the new effects, with no more parameters in all. Else that one only
  stands for the declared effect, which can stay.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

from hybridid.model import Model, Term
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import Comparison, compare
from hybridid.trace.noise_floor.accuracy import Accuracy
from hybridid.trace.refits.refit import CONTINUATION, refit, refit_if_possible
from hybridid.trace.refits.refitted import Refit, values_without
from hybridid.trace.rules import Rules
from hybridid.trace.search.pairs import in_place, with_pair
from hybridid.trace.search.search import continued, without_needless
from hybridid.trace.search.simpler import simplified
from hybridid.trace.search.steps import Accepted, Search
from hybridid.trace.trials.exchange import exchanged
from hybridid.trace.trials.judgement import differs_from_zero
from hybridid.trace.trials.trial import attempt

MORE = 2
"""Effects that may be accepted beyond those of the trace, in place of the one left out."""
Kind = Literal["better", "as_good"]
"""A replacement explains the records better, or as well with fewer free parameters."""


@dataclass(frozen=True)
class Replacement:
    """Effects that do better in the place of a declared one, or as well with ``fewer`` free parameters.

    ``gain`` is the relative decrease of the held-out RMSE against the last model of the trace. ``p_value`` is
    that of no decrease, adjusted; of a replacement that is ``as_good``, that of no increase. ``refit`` is the
    model with the effects ``accepted`` and without ``left_out``.
    """

    left_out: str
    accepted: tuple[Accepted, ...]
    refit: Refit
    kind: Kind
    gain: float
    p_value: float
    fewer: int


def replacements(model: Model, found: Search, context: Context) -> tuple[Replacement, ...]:
    """The replacements of declared effects of ``model`` that pass, one for each, the best first.

    ``found`` is what the search that only adds came to.
    """
    doubtful = [term for term in model.terms if _may_be_replaced(term, found)]
    ways = [(term, _ways_without(term, found, context)) for term in doubtful]
    tried = sum(max(1, _trials(way)) for _, every in ways for way in every)
    every = (_best(found.final, term, given, tried, context) for term, given in ways)
    return tuple(sorted((one for one in every if one is not None), key=_rank))


def _may_be_replaced(term: Term, found: Search) -> bool:
    """Whether a replacement of ``term`` can pass. Where the last model of ``found`` meets the noise, none can
    be better. It must have fewer parameters then, and one of its own at least."""
    poorer = found.first.model.without(term.name)
    return not found.at_noise or len(found.final.model.free) - len(poorer.free) > 1


def _rank(one: Replacement) -> tuple[bool, int, float]:
    """What explains the records better comes first, by its gain; then what has the fewest parameters."""
    better = one.kind == "better"
    return not better, 0 if better else -one.fewer, -one.gain


def _trials(way: Search) -> int:
    """Effects and pairs of them that were tried, or could have been."""
    return sum(len(step.trials) + step.family for step in way.steps)


def _ways_without(term: Term, found: Search, context: Context) -> list[Search]:
    """The search without ``term``, begun anew, and what ``found`` accepted, if it accepted something."""
    return [_without(term, found, context), *([_kept(term, found, context)] if found.accepted else [])]


def _best(
    last: Refit, term: Term, ways: Sequence[Search], tried: int, context: Context
) -> Replacement | None:
    """The best replacement of ``term`` that passes every test, if one does."""
    judged = [_held_against(last, term, way, tried, context.rules) for way in ways]
    for one in sorted((one for one in judged if one is not None), key=_rank):
        if _is_adequate(one, context) and not _may_stay(term, one, context):
            return one
    return None


def _held_against(last: Refit, term: Term, again: Search, tried: int, rules: Rules) -> Replacement | None:
    """What the search ``again`` accepted in the place of ``term``, if it passes against the ``last`` model.

    ``tried`` are the trials of all such searches.
    """
    if not again.accepted:
        return None
    revised, fewer = again.final, len(last.model.free) - len(again.final.model.free)
    better, worse = compare(last.score, revised.score), compare(revised.score, last.score)
    p_value = min(1.0, tried * better.p_value)
    if rules.passes(better.gain, p_value):
        return Replacement(term.name, again.accepted, revised, "better", better.gain, p_value, fewer)
    if fewer > 0 and _as_good(rules, revised, last):
        return Replacement(term.name, again.accepted, revised, "as_good", better.gain, worse.p_value, fewer)
    return None


def _is_as_good(worse: Comparison, samples: int, fewer: int, rules: Rules) -> bool:
    """Whether what the last model explains more is too little for the parameters that it has more.

    Of the plain errors of ``samples``, taken for white, the log-likelihood ratio is
    ``samples ln(loss / loss of the last model)``.
    """
    if worse.gain >= rules.tie or worse.likelihood_gain > fewer:
        return False
    return worse.p_value > rules.alpha or -samples * math.log1p(-worse.gain) <= fewer


def _is_adequate(one: Replacement, context: Context) -> bool:
    """Whether the error of a revised model leaves nothing to be explained; a better one need not."""
    if one.kind == "better" or context.meets_noise(one.refit.score):
        return True
    return Accuracy.of(one.refit, context).times(one.refit.score.rmse) <= context.rules.far


def _may_stay(term: Term, one: Replacement, context: Context) -> bool:
    """Whether nothing speaks against the declared ``term``: the revised model still needs it, or it does as
    well in the place of one of the new effects."""
    return _needed(term, one, context) or _stands_for(term, one, context)


def _needed(term: Term, one: Replacement, context: Context) -> bool:
    """Whether the effect that was left out still explains something beside those in its place."""
    rules, declared = context.rules, Candidate(term.effect, term.port)
    back = context.one(attempt, declared, one.refit, context.split, 0.0)
    if back.comparison is None:
        return False
    if one.kind == "better":
        return rules.passes(back.gain, back.comparison.p_value)
    significant = back.comparison.p_value <= rules.alpha or differs_from_zero(back, rules)
    return back.gain > 0 and significant


def _stands_for(term: Term, one: Replacement, context: Context) -> bool:
    """Whether one of the new effects only stands for ``term``: with ``term`` in its place the records are
    explained as well, by no more parameters."""
    declared, revised, rules = Candidate(term.effect, term.port), one.refit, context.rules
    given = [(revised, accepted.name, declared, context.split) for accepted in one.accepted]
    for other in context.mapper(exchanged, given):
        if other is None or len(other.model.free) > len(revised.model.free):
            continue
        advantage = compare(other.score, revised.score)
        if advantage.gain < rules.tie or advantage.p_value > rules.alpha:
            return True
    return False


def _without(term: Term, found: Search, context: Context) -> Search:
    """The forward search from the declared model without ``term``, which is not tried again."""
    first = found.first
    poorer, values = first.model.without(term.name), values_without(first, term.name)
    others = tuple(effect for effect in context.effects if effect.id != term.effect.id)
    rules = replace(context.rules, most_effects=len(found.accepted) + MORE)
    context.say(f"without {term.name}: the search is repeated")
    most_free = len(found.final.model.free) - 1 if found.at_noise else math.inf
    elsewhere = replace(context, effects=others, rules=rules, most_free=most_free)
    base = context.one(refit, poorer, context.split, [values], None, first.numerics, CONTINUATION)
    again = continued(Search((), base, (), ""), elsewhere)
    if not context.meets_noise(again.final.score):
        again = _with_pair(again, elsewhere)
    return simplified(again, partial(_as_good, context.rules), elsewhere)


def _as_good(rules: Rules, simpler: Refit, richer: Refit) -> bool:
    """Whether what the ``richer`` model explains more is too little for its further parameters."""
    fewer = len(richer.model.free) - len(simpler.model.free)
    return _is_as_good(compare(simpler.score, richer.score), int(simpler.score.samples.sum()), fewer, rules)


def _with_pair(again: Search, context: Context) -> Search:
    """``again`` with a pair of effects in the place of what it accepted, and what is found beside it."""
    paired = in_place(again, context) if again.accepted else with_pair(again, context)
    if paired is again or not paired.accepted:
        return again
    return continued(paired, context)


def _kept(term: Term, found: Search, context: Context) -> Search:
    """The last model of ``found`` without ``term``, and without accepted effects that are needless then."""
    last = found.final
    given = (last.model.without(term.name), context.split, [values_without(last, term.name)], last)
    poorer = context.one(refit_if_possible, *given, last.numerics, math.inf)
    if poorer is None:
        return Search((), last, (), "")
    shorter, accepted, _ = without_needless(poorer, list(found.accepted), context, new=0)
    return Search((), shorter, tuple(accepted), "")
