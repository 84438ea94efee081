"""Whether others should replace a declared effect: each one is left out, and the search is repeated.

A search that only adds cannot replace. Where viscous friction is declared, and Coulomb friction and quadratic
drag are true, each of the two alone may gain nothing beside the viscous term; only the pair replaces it.
Without the declared effect each of them gains by itself, so the search finds them one after the other.

The model so found must beat the last one of the trace on held-out horizons, by the same rules. Its p-value
counts every trial of every step of every such search (Bonferroni). And the effect that was left out must
explain nothing more beside them: else it belongs to the model, and further effects are missing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from hybridid.estimators import Estimate
from hybridid.model import Model, Term
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.evidence import compare
from hybridid.trace.refit import CONTINUATION, Refit, refit, values_without
from hybridid.trace.search import Accepted, Search, continued
from hybridid.trace.trial import attempt

MORE = 2
"""Effects that may be accepted beyond those of the trace, in place of the one left out."""


@dataclass(frozen=True)
class Replacement:
    """Effects that do better in the place of a declared one.

    ``gain`` is the relative decrease of the held-out RMSE against the last model of the trace, ``p_value`` is
    adjusted; ``refit`` is the model with the effects ``accepted`` and without ``left_out``.
    """

    left_out: str
    accepted: tuple[Accepted, ...]
    refit: Refit
    gain: float
    p_value: float


def replacements(model: Model, found: Search, context: Context) -> tuple[Replacement, ...]:
    """The replacements of declared effects of ``model`` that pass, the best first.

    ``found`` is what the search that only adds came to.
    """
    rules = context.rules
    searches = [(term, _without(term, found, context)) for term in model.terms]
    tried = sum(len(step.trials) for _, again in searches for step in again.steps)
    passing = []
    for term, again in searches:
        better = compare(found.final.score, again.final.score)
        p_value = min(1.0, tried * better.p_value)
        if not (again.accepted and rules.passes(better.gain, p_value)):
            continue
        if not _needed(term, again.final, context):
            passing.append(Replacement(term.name, again.accepted, again.final, better.gain, p_value))
    return tuple(sorted(passing, key=lambda one: -one.gain))


def _needed(term: Term, replaced: Refit, context: Context) -> bool:
    """Whether the effect that was left out still explains something beside those in its place."""
    back = context.one(
        attempt, Candidate(term.effect, term.port), replaced, context.split, context.rules.worth
    )
    return back.comparison is not None and context.rules.passes(back.gain, back.comparison.p_value)


def _without(term: Term, found: Search, context: Context) -> Search:
    """The forward search from the declared model without ``term``, which is not tried again."""
    first = found.first
    poorer, values = first.model.without(term.name), values_without(first, term.name)
    others = tuple(effect for effect in context.effects if effect.id != term.effect.id)
    rules = replace(context.rules, most_effects=len(found.accepted) + MORE)
    context.say(f"without {term.name}: the search is repeated")
    elsewhere = replace(context, effects=others, rules=rules)
    base = context.one(refit, poorer, context.split, [values], None, first.numerics, CONTINUATION)
    return continued(Search((), base, (), ""), elsewhere)


def idle_terms(model: Model, estimate: Estimate, sure: float = 2.0) -> tuple[str, ...]:
    """The effects of the declared ``model`` of which the records show nothing: in the ``estimate``, every
    amplitude is within ``sure`` standard errors of zero."""
    found = {p.name: p for p in estimate.parameters}

    def idle(term: Term) -> bool:
        nesting = [f"{term.name}.{p.name}" for p in term.effect.parameters if p.nests]
        names = [each for name in nesting for each in model.names_of(name)]
        amplitudes = [found[name] for name in names if name in found]
        return bool(amplitudes) and all(abs(p.value) <= sure * p.std for p in amplitudes)

    return tuple(term.name for term in model.terms if idle(term))
