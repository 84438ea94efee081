"""Withdraws a name whose form another function of the same variable outdoes.

A library holds a few laws of a variable, and a search names the nearest: an eddy-current brake for a damper
with a knee. An effect that is alone in its class claims its form F = k f(x), and not only that F depends on
x. So the other shapes of x that textbooks use (``hybridid.effects.shapes``) take its place in the last model,
if they have no more parameters and no effect that was tried has their form; all parameters are refitted. If
the name is right, no such shape predicts horizons that no fit has seen better, but by chance. The name is
withdrawn if one leaves less by more than ``Rules.tie``, significantly with all shapes counted, and also by
other numerics. Where the search ended at the noise, any difference is a small share of the error; there
``Rules.tie`` is not asked. A shape with more parameters is not tried: it could bend to something else that is
missing.
"""

from __future__ import annotations

from dataclasses import dataclass

from hybridid.declarations import PortKind
from hybridid.effects.composed import FORMS, composed, form_over
from hybridid.effects.over import MEMORIES, Over
from hybridid.effects.shapes import Shape, shapes_over
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.laws.law_starts import law_starts
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit, values_without
from hybridid.trace.search.steps import Accepted, Search
from hybridid.trace.trials.robustness import surviving
from hybridid.trace.trials.trial import Trial, attempt


@dataclass(frozen=True)
class NamedEffort:
    """An accepted effect as an effort (or flow) at ``port`` over a variable, in the model ``refit``."""

    port: str
    over: Over
    kind: PortKind
    refit: Refit


@dataclass(frozen=True)
class Outdone:
    """The accepted effect ``name`` at ``port``, a function of ``over``, and in words what outdoes it."""

    name: str
    port: str
    over: Over
    why: str


def other_form(found: Search, context: Context) -> Outdone | None:
    """The first accepted effect whose form another one outdoes; None if there is none, or the last model has
    not converged: then more may be had with the effect itself."""
    rules, final = context.rules, found.final
    least = 0.0 if found.at_noise else rules.tie
    asked = [(one, _others(one, context)) for one in found.accepted if final.converged]
    family = sum(len(shapes) for _, shapes in asked)
    for one, shapes in asked:
        for trial in _in_its_place(one, shapes, final, context) if shapes else ():
            assert trial.refit is not None
            better = compare(final.score, trial.refit.score)
            p_value = family * better.p_value
            if better.gain < least or p_value > rules.alpha:
                continue
            if surviving([trial.refit], final, context):
                over = _over(one)
                assert over is not None
                why = (
                    f"{trial.candidate.name} in its place, with no more parameters, leaves {better.gain:.1%} "
                    f"less (p = {min(p_value, 1.0):.1g})"
                )
                return Outdone(one.name, trial.candidate.port, over, why)
    return None


def _others(one: Accepted, context: Context) -> list[Shape]:
    """The shapes over the variable of an accepted effect that are asked in its place; none where it is one of
    a class, or its law no function of one variable."""
    over = _over(one)
    if over is None or len(one.alike) > 1:
        return []
    tried = {effect.id for effect in context.effects}

    def is_another(shape: Shape) -> bool:
        law = composed(over, shape, one.trial.candidate.effect.kind)
        free = sum(not p.fixed for p in law.parameters)
        return free <= one.trial.free_parameters and FORMS.get(law.id) not in tried

    return [shape for shape in shapes_over(over.variable) if is_another(shape)]


def _over(one: Accepted) -> Over | None:
    """Of what the law of an accepted effect is a function; None where that is not one variable, or a state
    with memory."""
    effect, ports = one.trial.candidate.effect, one.trial.candidate.ports
    over = form_over(effect) if len(ports) == 1 else None
    return over if over and over.variable not in MEMORIES else None


def _in_its_place(one: Accepted, shapes: list[Shape], final: Refit, context: Context) -> list[Trial]:
    """The refits of ``shapes`` in the place of an accepted effect, the best first."""
    over, candidate, split = _over(one), one.trial.candidate, context.split
    assert over is not None
    model, values = final.model.without(one.name), values_without(final, one.name)
    without = context.one(refit_if_possible, model, split, [values], final, final.numerics)
    if without is None:
        return []
    named = NamedEffort(candidate.port, over, candidate.effect.kind, final)
    given = [(named, shape, without, split, context.rules.worth) for shape in shapes]
    trials = context.each(f"other forms of {one.name}", _shaped, given, lambda t: t.candidate.name)
    ended = (t for t in trials if t.refit and not t.refit.ended_early)  # else its error is approximate
    return sorted(ended, key=lambda t: -t.taken)


def _shaped(named: NamedEffort, shape: Shape, without: Refit, split: Split, worth: float) -> Trial:
    """The model ``without`` the effect, with ``shape`` in its place. It ends early where it promises less
    than a quarter of what the effect takes."""
    law = composed(named.over, shape, named.kind, law_starts(named, shape, without, split))
    return attempt(Candidate(law, named.port), without, split, worth, None, named.refit)
