"""``LEVELS``: the second factor of a composed law, g(y), which sets the level of its first factor.

    F = k f(x) factor g(y),   y another variable than x

A force that a ripple of a magnet gives may fade with the temperature, a friction may rise from its level as a
joint warms. ``raised`` shapes are 1 + h g(y): a level that varies about one which is there anyway. The shapes
are those of ``hybridid.effects.shapes`` of amplitude one; their parameters end with 2.

Source: Hastie, Tibshirani (1993), Varying-coefficient models, J. Royal Statistical Society B 55(4), 757-796,
with a formula in the place of the free coefficient.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import casadi as ca

from hybridid.declarations import PortKind, Signal
from hybridid.effects.effect import Local
from hybridid.effects.over import MEMORIES, RECENT, RECENT_LOAD, Memory, Over, symbol_of, value_of
from hybridid.effects.shapes import PLACES, Shape, seen_at
from hybridid.effects.variable import Variable

FOLLOWED = (*PLACES, "input")
LATE = (RECENT, RECENT_LOAD)


class LevelShape(Shape):
    """A shape of ``LEVELS``; another process finds it by its name there."""

    def __reduce__(self) -> tuple[Callable[[str], Shape], tuple[str]]:
        return _level_named, (self.name,)


LEVELS = (
    LevelShape(
        "proportional", "{x}", 1, {}, lambda at, p: at.x,
        ("velocity", *PLACES, "time", "load", "input", *LATE), (),
    ),
    LevelShape("modulus", "|{x}|", 1, {}, lambda at, p: at.size, ("velocity", *PLACES, "load", "input"), ()),
    LevelShape("square", "{x}²", 2, {}, lambda at, p: at.x**2, ("velocity", *PLACES, "load", "input"), ()),
    LevelShape(
        "shifted", "({x} - c_2)", 1, {"c_2": "place"}, lambda at, p: at.x - p.c_2,
        (*FOLLOWED, "time", "load", *LATE), (),
    ),
    LevelShape(
        "above", "max({x} - c_2, 0)", 1, {"c_2": "place"}, lambda at, p: ca.fmax(at.x - p.c_2, 0),
        (*FOLLOWED, "time", "load"), (),
    ),
    LevelShape(
        "raised_modulus", "(1 + |{x}|/s_2)", 0, {"s_2": "width"}, lambda at, p: 1 + at.size / p.s_2,
        ("velocity", "load", "input"), (),
    ),
    LevelShape(
        "saturating", "tanh(|{x}|/s_2)", 0, {"s_2": "width"}, lambda at, p: ca.tanh(at.size / p.s_2),
        ("velocity", "load", "input"), (),
    ),
    LevelShape(
        "peak", "2 (|{x}|/s_2) / (1 + ({x}/s_2)²)", 0, {"s_2": "width"},
        lambda at, p: 2 * (at.size / p.s_2) / (1 + (at.x / p.s_2) ** 2), ("velocity",), (),
    ),
    LevelShape(
        "gaussian", "exp(-({x}/s_2)²)", 0, {"s_2": "width"}, lambda at, p: ca.exp(-((at.x / p.s_2) ** 2)),
        ("velocity",), (),
    ),
    LevelShape(
        "bump", "exp(-(({x} - c_2)/s_2)²)", 0, {"c_2": "place", "s_2": "width"},
        lambda at, p: ca.exp(-(((at.x - p.c_2) / p.s_2) ** 2)), (*PLACES, "time"), (),
    ),
    LevelShape(
        "raised_bump", "(1 + h_2 exp(-(({x} - c_2)/s_2)²))", 0,
        {"c_2": "place", "s_2": "width", "h_2": "share"},
        lambda at, p: 1 + p.h_2 * ca.exp(-(((at.x - p.c_2) / p.s_2) ** 2)), (*PLACES, "time"), (),
    ),
    LevelShape(
        "step", "(1 + tanh(({x} - c_2)/s_2))/2", 0, {"c_2": "place", "s_2": "width"},
        lambda at, p: (1 + ca.tanh((at.x - p.c_2) / p.s_2)) / 2, (*FOLLOWED, "time", "load"), (),
    ),
    LevelShape(
        "raised_step", "(1 + h_2 (1 + tanh(({x} - c_2)/s_2))/2)", 0,
        {"c_2": "place", "s_2": "width", "h_2": "share"},
        lambda at, p: 1 + p.h_2 * (1 + ca.tanh((at.x - p.c_2) / p.s_2)) / 2, (*FOLLOWED, "time"), (),
    ),
    LevelShape(
        "fading", "exp(-{x}/s_2)", 0, {"s_2": "width"}, lambda at, p: ca.exp(-at.x / p.s_2),
        ("time", *LATE), (),
    ),
    LevelShape(
        "raised_fading", "(1 + h_2 exp(-{x}/s_2))", 0, {"s_2": "width", "h_2": "share"},
        lambda at, p: 1 + p.h_2 * ca.exp(-at.x / p.s_2), ("time", *LATE), (),
    ),
)  # fmt: skip
"""The levels, those without a shape parameter first; none has an amplitude of its own."""


@dataclass(frozen=True)
class Level:
    """``g(y)``, the shape called ``name`` over ``over``, which has no factor."""

    over: Over
    name: str

    @property
    def shape(self) -> Shape:
        """The function g."""
        return next(shape for shape in levels_over(self.over) if shape.name == self.name)

    @property
    def memory(self) -> Memory | None:
        """The state that the variable brings, if it is one with memory."""
        return MEMORIES.get(self.over.variable)

    def __call__(self, at: Local) -> ca.SX:
        return self.shape.function(seen_at(self.over, at, value_of(self.over, at)), at.p)

    @property
    def equation(self) -> str:
        """``|L|``."""
        return self.shape.equation.format(x=symbol_of(self.over))


def levels_over(over: Over) -> tuple[Shape, ...]:
    """The levels that suit a variable."""
    return tuple(shape for shape in LEVELS if over.variable in shape.suits)


def overs_of_level(first: Over, kind: PortKind, signals: Sequence[Signal]) -> tuple[Over, ...]:
    """The variables that may set the level of a law over ``first``.

    They are others than its own, with one memory and one input or channel in the whole law. A law over an
    inertia or a section has none: there the level would have to stand in Lagrange's equation.
    """
    if first.factor in ("acceleration", "net flow"):
        return ()
    plain: tuple[Variable, ...] = (
        ("level", "time") if kind == "flow" else ("velocity", "position", "time", "load", *LATE)
    )
    every = [Over(variable) for variable in plain]
    if first.signal is None:
        every += [Over("input", "", signal) for signal in signals]
    remembers = first.variable in MEMORIES
    return tuple(
        one
        for one in every
        if one.variable != first.variable and not (remembers and one.variable in MEMORIES)
    )


def _level_named(name: str) -> Shape:
    return next(shape for shape in LEVELS if shape.name == name)
