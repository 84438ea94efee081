"""Accepted effects whose amplitude is no constant: a varying-coefficient model beside an accepted effect.

A law of the library is a form times a constant amplitude. A machine may have the form and another amplitude
at every load, place or time: a detent that a spring presses, friction that a temperature sets. The library's
law is then the best available one, and the variation of its amplitude stays in the error. So where the search
did not end at the noise, the amplitude of each accepted effect at an effort or flow port is freed:

    F = law (1 + sum_j a_j b_j(s)),   s a variable of the port, b_j as in
    ``hybridid.trace.learned.learned_effort``

With all a_j at zero this is the accepted model. The law's largest amplitude is held, as a constant is a
function of s too. If it takes most of the squared error that is left
(``Rules.majority``), significantly with all such trials counted, and under other numerics as well, the
amplitude is no constant and the law is not that of the library: the name is withdrawn. (No
model takes that much from noise alone, so this needs no estimate of the noise.)

Source: Hastie, Tibshirani (1993), Varying-coefficient models, J. Royal Statistical Society B 55(4), 757-796.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import casadi as ca

from hybridid.declarations import Port
from hybridid.effects.composed import ComposedLaw
from hybridid.effects.dimension import ONE
from hybridid.effects.effect import LOAD_WIDTH, Effect, EffectParameter, Local
from hybridid.effects.over import MEMORIES, Over
from hybridid.model import Term
from hybridid.naming import listed
from hybridid.plants.plant import TOGETHER
from hybridid.simulation.stability import TooStiff
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.learned.ceiling import TOLERANCE
from hybridid.trace.learned.law_curve import is_curve_over
from hybridid.trace.learned.learned_effort import Bumps, learned_effort
from hybridid.trace.learned.separable import is_separable
from hybridid.trace.ports.path import Array, Path
from hybridid.trace.refits.refit import FAILURES, WITHOUT_STD, least_of, refit_if_hopeful
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.trials.robustness import surviving


@dataclass(frozen=True)
class VaryingLaw:
    """The law of ``effect``, times one plus a learned function of a variable."""

    effect: Effect
    learned: Bumps

    def __call__(self, at: Local) -> ca.SX:
        return self.effect.law(at) * (1 + self.learned(at))


@dataclass(frozen=True)
class DynamicsOf:
    """The dynamics of all ``effects``; it pickles, as a lambda does not."""

    effects: tuple[Effect, ...]

    def __call__(self, at: Local) -> Mapping[str, ca.SX]:
        own = [one.dynamics(at) for one in self.effects if one.dynamics is not None]
        return {name: rate for rates in own for name, rate in rates.items()}


@dataclass(frozen=True)
class Varied:
    """The model with the amplitude of the term ``name`` free over ``over``; None if it cannot be solved."""

    name: str
    over: Over
    refit: Refit | None
    p_value: float = 1.0


def varying(effect: Effect, over: Over, seen: Array, remembers: float = 1.0) -> Effect:
    """``effect`` with an amplitude that varies over ``over``, on the range of ``seen`` (n,); ``remembers`` is
    the guess of the variable's memory, if it has one."""
    learned = learned_effort(effect.kind, over, seen, remembers=remembers)
    assert isinstance(learned.law, Bumps)
    shares = [replace(p, dimension=ONE, nests=False) if p.nests else p for p in learned.parameters]
    states = (*effect.states, *learned.states)
    return replace(
        effect,
        law=VaryingLaw(effect, learned.law),
        states=states,
        dynamics=DynamicsOf((effect, learned)) if states else None,
        parameters=(*effect.parameters, *shares),
        needs=tuple(dict.fromkeys((*effect.needs, *over.needs))),
        channels=tuple(dict.fromkeys((*effect.channels, *over.channels))),
    )


def not_constant(final: Refit, names: list[str], context: Context) -> tuple[str, str] | None:
    """The first of the accepted ``names`` whose amplitude is no constant in the model ``final``, and why."""
    places = [(name, over) for name in names for over in _overs(final, name, context)]
    given = [(final, context.split, name, over, least_of(context.rules.worth)) for name, over in places]
    tried = context.each("amplitudes", vary, given, lambda one: f"{one.name} over {one.over}")
    left, rules = final.score.loss**2, context.rules
    found = [(one, one.refit) for one in tried if one.refit is not None]
    if unsolved := [f"{one.name} over {one.over}" for one in tried if one.refit is None]:
        context.say(f"amplitudes that no fit could free: {listed(unsolved)}")
    for one, freed in sorted(found, key=lambda pair: pair[1].score.loss):
        share = 1 - freed.score.loss**2 / left
        if share < rules.majority or len(tried) * one.p_value > rules.alpha:
            continue
        if surviving([freed], final, context):
            return one.name, (
                f"its amplitude is no constant: as a function of {one.over} it takes {share:.0%} of the "
                "squared error that is left"
            )
    return None


def _overs(final: Refit, name: str, context: Context) -> list[Over]:
    """Variables without memory over which the amplitude of the term ``name`` may vary.

    Not those over which its effort is a curve, alone or times a function of other variables. A freed
    amplitude would then add up all effects of that variable: with friction that grows with the load, all
    other frictions that do.
    """
    term = next(term for term in final.model.terms if term.name == name)
    port = final.model.plant.port(term.port.split(TOGETHER)[0])
    if port.kind not in ("effort", "flow"):
        return []
    path, law = Path.of(final, context.split, context.split.fitted), term.effect.law
    own = [over.variable for over in law.overs] if isinstance(law, ComposedLaw) else []
    plain = [
        one
        for one in context.overs(port, final.model)
        if not one.factor and one.variable not in MEMORIES and one.variable not in own
    ]
    return [
        one
        for one in plain
        if path.shows(port.name, one)
        and not _is_own(final, term, port, one)
        and not is_curve_over(final, name, port.name, one, context.split)
    ]


def _is_own(final: Refit, term: Term, port: Port, over: Over) -> bool:
    """Whether the law of ``term`` at ``port`` is a function of the variable, times a function of others."""
    own = {p.name: final.values[f"{term.name}.{p.name}"] for p in term.effect.parameters}
    constants = {**own, "epsilon": port.epsilon, "load_width": LOAD_WIDTH * port.effort_scale}
    carried = dict.fromkeys(("drive", "load"), port.effort_scale)
    sizes = {"position": port.position_scale, "velocity": port.velocity_scale, **carried}
    return is_separable(term.effect, constants, over, sizes)


def held_at(values: Mapping[str, float], free: Effect) -> Effect:
    """``free``, an effect whose amplitude varies, with the largest of its amplitudes held at its value;
    ``values`` are those of the effect, by short name."""
    largest = max((p.name for p in free.parameters if p.nests), key=lambda name: abs(values[name]))

    def held(p: EffectParameter) -> EffectParameter:
        if p.name != largest:
            return p
        return EffectParameter(
            p.name, p.dimension, p.meaning, values[p.name], nests=True, absolute=True, fixed=True
        )

    return replace(free, parameters=tuple(map(held, free.parameters)))


def vary(final: Refit, split: Split, name: str, over: Over, least: float) -> Varied:
    """Refit ``final`` with the amplitude of the term ``name`` free over ``over``."""
    term = next(term for term in final.model.terms if term.name == name)
    path, port = Path.of(final, split, split.fitted), term.port.split(TOGETHER)[0]
    own = {p.name: final.values[f"{name}.{p.name}"] for p in term.effect.parameters}
    free = varying(term.effect, over, path.covered(port, over), path.memory(port, over.variable))
    free = held_at(own, free)
    model = final.model.without(name).plus(free, term.port)
    memory, at = MEMORIES.get(over.variable), model.plant.port(port)
    remembering = [p for p in free.parameters if memory is not None and p.name == memory.name]
    others = [{f"{name}.{p.name}": value} for p in remembering for value in p.starts_at(at)]
    try:
        freed = refit_if_hopeful(
            model,
            split,
            [{**final.values, **one} for one in ({}, *others)],
            final,
            final.numerics,
            final,
            least,
            tolerance=TOLERANCE,
            std_up_to=WITHOUT_STD,
        )
    except (TooStiff, *FAILURES):
        return Varied(name, over, None)
    return Varied(name, over, freed, compare(final.score, freed.score).p_value)
