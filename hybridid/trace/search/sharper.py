"""The smoothing of sign(v) made narrower where it leaves a part of the error.

A machine that sticks does not creep as tanh(v/epsilon) does. Where the smoothing leaves an error, an effect
that creeps less (a bristle, a hysteresis) takes it, and seems to be missing. So before effects are tried
beside a model, it is refitted with half of each epsilon, and again, as long as that takes as much from the
held-out error as an effect must (``Rules.worth``). It is the simulation's error that goes: no law was added.
What a machine that creeps shows may lie between two halves. A gauge with another range may then stand for
the rest. So the epsilons are fitted in between as well, and kept if the model then meets the noise: beside a
model that lacks something, they would bend to that. A half may also take more steps than a trial is given.
The declared model is refitted with these all the same, and kept if it meets the noise: then no trial follows.

Beside a model that lacks an effect, that error may hardly count, and beside the effect decide: a resonance
that a machine excites as it sticks is not seen where it creeps instead. So where no effect passes, or only
one that is minor, those that gain most are tried once more with half of each epsilon. If one passes then that
did not before, the step is made again with that. If it accepts nothing all the same, the wider one stays.

Source: Roache (1998), Verification and Validation in Computational Science and Engineering, ch. 3: the error
of a solution is made small before the model is judged.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from hybridid.declarations import Parameter
from hybridid.model import Model
from hybridid.naming import listed
from hybridid.quantities import quantity
from hybridid.simulation.stability import MOST
from hybridid.trace.context import Context
from hybridid.trace.entries import Width
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.learned.minor import MINOR
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.search.halving import halved_while_it_pays
from hybridid.trace.search.steps import Step
from hybridid.trace.trials.judgement import judge
from hybridid.trace.trials.trial import PASSED, attempt

MOST_BY_ITSELF = 16 * MOST
"""Steps a sample of a model that is refitted by itself: a few refits, where beside it a hundred follow."""
RETRIED = 3
"""Effects, those that gain most, that are tried with a narrower smoothing where none passes."""


def sharp_enough(base: Refit, context: Context, declared: bool = False) -> Refit:
    """``base``, or its refit over as narrow a smoothing as pays. An epsilon that the user has fixed stays.
    ``declared``: it holds no effect that was found, so no refit follows where it meets the noise.

    Where a half does not pay, a quarter may: in the same steps, the narrower law is integrated less well, and
    that may take more than the smoothing left. Shorter steps come with the next half.
    """
    kept = halved_while_it_pays(
        base, lambda one: _halved(one, context), lambda one: _said(one.model), context
    )
    if context.meets_noise(kept.score):
        return kept
    sharp = _down_to_the_noise(kept, context) if declared else None
    return sharp or _between_halves(kept, kept is not base, context)


def sharper_for_an_effect(step: Step, context: Context) -> Refit | None:
    """The model of a ``step`` that accepted no effect with half of each epsilon, if one then passes that did
    not before."""
    rules = context.rules
    possible = [t for t in step.trials if t.comparison and t.gain >= rules.worth]
    if not possible or (sharp := _halved(step.base, context)) is None:
        return None
    best = sorted(possible, key=lambda t: -t.gain)[:RETRIED]
    given = [(t.candidate, sharp, context.split, rules.worth) for t in best]
    tried = context.each("narrower smoothing", attempt, given, lambda t: t.candidate.name)
    minor = [t.candidate.name for t in step.trials if t.reason.startswith(MINOR)]
    judged = [t for t in judge(tried, rules, len(step.trials)) if t.candidate.name not in minor]
    passed = [t.candidate.name for t in judged if t.status == PASSED]
    if not passed:
        return None
    context.say(f"{_said(sharp.model)} from here on: then {listed(passed)} passes")
    return sharp


def explains_more_wider(step: Step, wider: Refit, context: Context) -> bool:
    """Whether one of the effects of ``step`` that gain most leaves less than all of them do, by
    ``Rules.worth``, with the epsilons of ``wider``."""
    fitted = sorted((t.refit for t in step.trials if t.refit is not None), key=lambda one: one.score.loss)
    if not fitted or context.out_of_time:
        return False
    widths = {p.name: {"guess": p.guess} for p in _widths(wider.model)}
    again = [_with_widths(one, widths, context) for one in fitted[:RETRIED]]
    least = min((one.score.loss for one in again if one is not None), default=math.inf)
    if least > (1.0 - context.rules.worth) * fitted[0].score.loss:
        return False
    context.say(
        f"beside an effect less error is left if {_said(wider.model)}: the step is made again with that"
    )
    return True


def _halved(base: Refit, context: Context) -> Refit | None:
    """``base`` refitted with half of each epsilon that the user has not fixed; None if there is none, or it
    cannot be simulated."""
    halves = {p.name: {"guess": p.guess / 2} for p in _widths(base.model)}
    return _with_widths(base, halves, context) if halves else None


def _down_to_the_noise(base: Refit, context: Context) -> Refit | None:
    """``base`` with each epsilon halved as long as that pays for an output, in more steps than a trial is
    given, if that leaves the noise, or so little more that no effect could take what is worth having: then
    nothing is tried beside it. Else None. What pays for one output may be too little of the whole error to
    pay for trials in as many steps."""
    one = base
    while 2 * one.substeps <= MOST_BY_ITSELF and not context.meets_noise(one.score):
        again = _halved(replace(one, substeps=2 * one.substeps), context)
        if again is None:
            break
        pays = compare(one.score, again.score).largest >= context.rules.worth
        if pays or (_is_enough(again, context) and not _is_enough(one, context)):
            one = again
        if not pays:
            break
    if one is base or not _is_enough(one, context):
        return None
    context.say(f"{_said(one.model)} from here on: that leaves hardly more than the noise")
    return one


def _is_enough(one: Refit, context: Context) -> bool:
    """Whether ``one`` leaves so little that no effect is sought beside it."""
    return context.meets_noise(one.score) or context.noise_leaves_no_room(one.score)


def _between_halves(base: Refit, halved: bool, context: Context) -> Refit:
    """``base`` with the epsilons that the records show between half and twice those that it has, if it then
    meets the noise."""
    free = free_widths(base.model, halved)
    if not free:
        return base
    fitted = _with_widths(base, free, context)
    if fitted is None or not context.meets_noise(fitted.score):
        return base
    found = {name: {"guess": fitted.values[name]} for name in free}
    again = _with_widths(replace(base, values=fitted.values), found, context)
    if again is None or not context.meets_noise(again.score):
        return base
    context.say(f"{_said(again.model)} from here on: that leaves the noise alone")
    return again


def free_widths(model: Model, halved: bool = False) -> dict[str, dict[str, float]]:
    """The epsilons of ``model`` as adjustments with which a refit fits them too, between half and twice what
    they are. None becomes wider than that of its port, but for those that were ``halved``."""
    ports = {f"{port.name}.epsilon": port.epsilon for port in model.plant.ports}
    free = {}
    for p in _widths(model):
        widest = 2 * p.guess if halved else max(p.guess, ports[p.name])
        free[p.name] = {"lower": p.guess / 2, "guess": p.guess, "upper": min(2 * p.guess, widest)}
    return free


def _with_widths(base: Refit, widths: Mapping[str, Mapping[str, float]], context: Context) -> Refit | None:
    """``base`` refitted with other adjustments of its epsilons; None if that cannot be simulated."""
    model = replace(base.model, adjustments={**base.model.adjustments, **widths})
    values = {name: value for name, value in base.values.items() if name not in widths}
    given = (model, context.split, [values], base, base.numerics, math.inf)
    (again,) = context.each("narrower smoothing", refit_if_possible, [given])
    return again


def _said(model: Model) -> str:
    widths = [f"{quantity(p.guess, p.unit)} ({p.name})" for p in _widths(model)]
    return f"sign(v) is smoothed over {listed(widths)}"


def narrowed(declared: Model, final: Model) -> tuple[Width, ...]:
    """The epsilons of ``final`` that are no longer those of its ports, or of the ``declared`` model."""
    before = {p.name: p.guess for p in replace(final, adjustments=declared.adjustments).parameters}
    return tuple(
        Width(p.name, p.unit, before[p.name], p.guess) for p in _widths(final) if p.guess != before[p.name]
    )


def _widths(model: Model) -> list[Parameter]:
    """The epsilons that are constants, and that the user has not fixed."""
    return [
        p
        for p in model.parameters
        if p.name.endswith(".epsilon") and p.fixed and "fixed" not in model.adjustments.get(p.name, {})
    ]
