"""A composed law: amplitude × f(one variable) × factor × level, f of ``hybridid.effects.shapes``.

    F = k f(x) factor g(y),   x of ``hybridid.effects.over``,   factor = 1, v, sign(v) or the drive

or an inertia m = k f(x). The level g(y) is one, or a shape over another variable
(``hybridid.effects.levels``).

It is an effect like those of the library, but no physical name: a trace proposes one where no effect of the
library explains what is missing. Its id says what it is, as ``modulus_of_velocity``,
``bump_of_position_times_sign_of_velocity`` or ``sine_of_position_by_modulus_of_load``, and can be written
wherever the id of an effect can.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca

from hybridid.declarations import PortKind, Signal
from hybridid.effects.dimension import ONE, Dimension
from hybridid.effects.effect import Effect, EffectParameter, Local
from hybridid.effects.levels import Level, levels_over, overs_of_level
from hybridid.effects.over import (
    BRISTLE,
    FLOW_FACTORS,
    MEMORIES,
    OVERS,
    OVERS_OF_A_FLOW,
    RECENT,
    RECENT_LOAD,
    Over,
    effort_of,
    equation_of,
    over_inputs,
    symbol_of,
)
from hybridid.effects.shapes import Role, Shape, seen_at, shapes_over
from hybridid.effects.variable import Variable
from hybridid.naming import listed, unknown

WIDE = 1e4
"""Times its scale, a shape parameter may be, up or down, where no record bounds it."""
EXPONENTS = (0.1, 10.0)
"""Bounds of an exponent."""
OUTSIDE = 2.0
"""Times the scale of its variable, where a pole lies as long as no record says where."""
OF, TIMES, BY = "_of_", "_times_", "_by_"
FORMS: Mapping[str, str] = {
    "proportional_of_velocity": "viscous",
    "sign_of_velocity": "coulomb",
    "modulus_of_velocity": "asymmetric_viscous",
    "signed_square_of_velocity": "quadratic_drag",
    "stribeck_of_velocity": "stribeck",
    "peak_of_velocity": "eddy_brake",
    "square_beyond_gap_of_velocity": "centrifugal_brake",
    "proportional_of_position": "linear_stiffness",
    "shifted_of_position": "preloaded_spring",
    "cube_of_position": "cubic_stiffness",
    "shifted_cube_of_position": "cubic_stiffness",
    "above_of_position": "end_stop",
    "below_of_position": "end_stop",
    "proportional_of_time_times_sign_of_velocity": "friction_drift",
    "shifted_of_time_times_sign_of_velocity": "friction_drift",
    "sine_of_position": "cogging",
    "bump_of_position": "detent",
    "modulus_of_load_times_sign_of_velocity": "load_friction",
    "proportional_of_position_times_sign_of_velocity": "position_friction",
    "shifted_of_position_times_sign_of_velocity": "position_friction",
    "sine_of_position_times_sign_of_velocity": "cyclic_friction",
    "proportional_of_position_times_velocity": "position_damping",
    **{
        f"{shape}_of_position_times_acceleration": "varying_inertia"
        for shape in ("proportional", "square", "shifted", "parabola", "bump")
    },
    "sine_of_position_times_acceleration": "cyclic_inertia",
    **{
        f"{shape}_of_position_times_drive": "varying_force_factor"
        for shape in ("proportional", "square", "shifted", "parabola")
    },
    "sine_of_position_times_drive": "torque_ripple",
    "proportional_of_level_times_drive": "falling_supply",
    "saturating_of_level_times_drive": "falling_supply",
    "proportional_of_bristle_deflection": "dahl",
    "proportional_of_load": "input_gain",
}
"""Effects of the library that have the form of a law, whether a trace tried them or not."""
SOURCE = "composed of the shapes in hybridid.effects.shapes"


_WHERE: Mapping[Variable, str] = {
    "load": ", L = drive - load",
    RECENT: ", tau r' = |v| - r",
    RECENT_LOAD: ", tau r' = |L| - r, L = drive - load",
    BRISTLE: ", d z' = v - |v| z",
}


@dataclass(frozen=True)
class Bounded:
    """Where a shape parameter starts, and its bounds, in SI units."""

    guess: float
    lower: float
    upper: float


@dataclass(frozen=True)
class ComposedLaw:
    """``amplitude × f(x) × factor × level``. Another process finds a class by its name, a shape by its."""

    over: Over
    name: str
    level: Level | None = None

    @property
    def shape(self) -> Shape:
        """The function f."""
        return next(shape for shape in shapes_over(self.over.variable) if shape.name == self.name)

    def __call__(self, at: Local) -> ca.SX:
        alone = effort_of(self.over, at, lambda x: self.shape.function(seen_at(self.over, at, x), at.p))
        return alone if self.level is None else alone * self.level(at)

    @property
    def equation(self) -> str:
        """``F = k |q| sign(v)``; with a level ``F = k |q| sign(v) |L|, L = drive - load``."""
        text = self.shape.equation.format(x=symbol_of(self.over))
        several = len(self.shape.amplitudes) > 1
        if several and (self.level or self.over.factor not in ("", "acceleration")):
            text = f"({text})"
        text = equation_of(self.over, text)
        level = f" {self.level.equation}" if self.level else ""
        drive = ", D = drive" if self.over.factor == "drive" else ""
        return text + level + drive + "".join(_WHERE.get(one.variable, "") for one in self.overs)

    @property
    def overs(self) -> tuple[Over, ...]:
        """The variables of its factors."""
        return (self.over,) if self.level is None else (self.over, self.level.over)

    @property
    def id(self) -> str:
        """What it is, as one word."""
        times = f"{TIMES}{self.over.factor}" if self.over.factor else ""
        by = f"{BY}{self.level.name}{OF}{self.level.over.name}" if self.level else ""
        return f"{self.name}{OF}{self.over.name}{times}{by}".replace(" ", "_")


def is_composed(effect: Effect) -> bool:
    """Whether an effect is a composed law, and no effect with a physical name."""
    return isinstance(effect.law, ComposedLaw)


def composed(
    over: Over,
    shape: Shape,
    kind: PortKind = "effort",
    starts: Mapping[str, Bounded] | None = None,
    level: Level | None = None,
) -> Effect:
    """The law ``shape`` over ``over`` as an effect of ``kind``, times a ``level`` if one is given.

    ``starts`` gives guesses and bounds of parameters in SI units, by name; the others are guessed by the
    port's scales.
    """
    law, given = ComposedLaw(over, shape.name, level), starts or {}
    amplitude = over.amplitude.times(over.dimension, -shape.power)
    fine = shape.finer(over)
    own = [_further(key, over.dimension, role, given, fine) for key, role in shape.roles.items()]
    hard = shape.contact(over)
    if level is not None:
        y = level.over.dimension
        amplitude = amplitude.times(y, -level.shape.power)
        own += [_further(key, y, role, given) for key, role in level.shape.roles.items()]
    memory = next((MEMORIES[one.variable] for one in law.overs if one.variable in MEMORIES), None)
    if memory is not None:
        own.append(_with_bounds(memory.name, memory.dimension, memory.meaning, given))
    return Effect(
        id=law.id,
        kind=kind,
        title=f"a law over {listed([str(one) for one in law.overs])}",
        equation=law.equation,
        law=law,
        parameters=(*(_amplitude(key, amplitude, given, hard) for key in shape.amplitudes), *own),
        states=(memory.state,) if memory else (),
        dynamics=memory.dynamics if memory else None,
        needs=tuple(dict.fromkeys(need for one in law.overs for need in one.needs)),
        channels=tuple(name for one in law.overs for name in one.channels),
        source=SOURCE,
        pattern=f"it has the form of {FORMS[law.id]}"
        if law.id in FORMS
        else "no effect of the library has its form",
    )


def composed_named(
    name: str,
    signals: Iterable[Signal] = (),
    starts: Mapping[str, Bounded] | None = None,
    at: PortKind | None = None,
) -> Effect | None:
    """The composed law whose id is ``name``, over the variables of any port and over ``signals``; None if it
    is none. ``starts`` as ``composed`` has them.

    A law over an input has the same id at an effort port and at a flow port. ``at`` says which is meant
    (None: an effort port).
    """
    known = tuple(signals)
    first, by, _ = name.partition(BY)
    for kind, over in _all_overs(known):
        if at not in (None, kind):
            continue
        for shape in shapes_over(over.variable):
            if ComposedLaw(over, shape.name).id != first:
                continue
            if not by:
                return composed(over, shape, kind, starts)
            for level in levels_beside(over, kind, known):
                if ComposedLaw(over, shape.name, level).id == name:
                    return composed(over, shape, kind, starts, level)
    return None


def levels_beside(over: Over, kind: PortKind, signals: Sequence[Signal]) -> Iterator[Level]:
    """Every level that a law over ``over`` may have."""
    for other in overs_of_level(over, kind, signals):
        yield from (Level(other, shape.name) for shape in levels_over(other))


def form_over(effect: Effect) -> Over | None:
    """The variable and the factor of the composed laws that have the form of ``effect``; None if none has."""
    for name in (law for law, form in FORMS.items() if form == effect.id):
        same = composed_named(name, at=effect.kind) if effect.kind in ("effort", "flow") else None
        if same is not None and isinstance(same.law, ComposedLaw):
            return same.law.over
    return None


def law(
    name: str, over: tuple[str, str] | None = None, at: PortKind | None = None, **guesses: float
) -> Effect:
    """The composed law whose id is ``name``, its parameters guessed at ``guesses`` (SI units).

    ``over`` is the name and the unit of the input or channel that it follows, if it follows one; ``at`` the
    kind of port, as ``composed_named`` has it.

    Raises:
        ValueError: if no law has that id, or none of its parameters one of the names.
    """
    signals = () if over is None else (Signal(*over),)
    plain = composed_named(name, signals, at=at)
    if plain is None:
        raise ValueError(f"{name!r} is the id of no composed law (hybridid.effects.shapes)")
    allowed = {p.name: p for p in plain.parameters}
    for key in guesses:
        if key not in allowed:
            raise ValueError(f"law {name}: {unknown('parameter', key, allowed)}")
    bounds = {key: _around(value, bool(allowed[key].lower > 0)) for key, value in guesses.items()}
    found = composed_named(name, signals, bounds, at)
    assert found is not None
    return found


def _around(value: float, positive: bool) -> Bounded:
    return Bounded(value, value / WIDE, value * WIDE) if positive else Bounded(value, -math.inf, math.inf)


def _all_overs(signals: Iterable[Signal]) -> Iterator[tuple[PortKind, Over]]:
    known = tuple(signals)
    yield from (("effort", over) for over in (*OVERS, *over_inputs(known)))
    yield from (("flow", over) for over in (*OVERS_OF_A_FLOW, *over_inputs(known, FLOW_FACTORS)))


def _amplitude(name: str, dimension: Dimension, given: Mapping[str, Bounded], hard: bool) -> EffectParameter:
    guess = given[name].guess if name in given else 0.1
    return EffectParameter(name, dimension, "amplitude", guess, nests=True, hard=hard, absolute=name in given)


_MEANINGS: Mapping[Role, str] = {
    "place": "where the shape lies",
    "pole": "where the shape has no end",
    "width": "how wide the shape is",
    "period": "period",
    "share": "by which share the level rises",
    "exponent": "exponent",
    "reference": "where the shape is one",
}


_SOUGHT: Mapping[Role, Literal["period", "place"]] = {"period": "period", "place": "place"}


def _further(
    name: str, x: Dimension, role: Role, given: Mapping[str, Bounded], fine: bool = False
) -> EffectParameter:
    """A shape parameter over a variable of dimension ``x``. The period or place of a ``fine`` shape is sought
    in the record: no learned effort shows where to start."""
    if role == "reference":
        value = given[name].guess if name in given else 1.0
        return EffectParameter(name, x, _MEANINGS[role], value, fixed=True, absolute=name in given)
    if role == "exponent":
        value = given[name].guess if name in given else 1.5
        return EffectParameter(name, ONE, _MEANINGS[role], value, *EXPONENTS, absolute=name in given)
    if role == "share":
        return _with_bounds(name, ONE, _MEANINGS[role], given, unbounded=True)
    if role == "pole" and name not in given:
        return EffectParameter(name, x, _MEANINGS[role], OUTSIDE)
    return _with_bounds(
        name,
        x,
        _MEANINGS[role],
        given,
        unbounded=role == "place",
        sought=_SOUGHT.get(role, "") if fine else "",
    )


def _with_bounds(
    name: str,
    dimension: Dimension,
    meaning: str,
    given: Mapping[str, Bounded],
    unbounded: bool = False,
    sought: Literal["", "period", "place"] = "",
) -> EffectParameter:
    """A parameter that is no amplitude: within the bounds that are given, else any if it may be zero, or
    any positive one."""
    if name in given:
        one = given[name]
        return EffectParameter(
            name, dimension, meaning, one.guess, one.lower, one.upper, absolute=True, sought=sought
        )
    if unbounded:
        return EffectParameter(name, dimension, meaning, guess=0.0)
    return EffectParameter(name, dimension, meaning, 0.3, 1 / WIDE, WIDE, sought=sought)
