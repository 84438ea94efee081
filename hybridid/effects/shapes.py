"""``SHAPES``: functions of one variable x that the textbooks use for efforts and flows.

A law that no effect of the library has is composed of one of them, times an amplitude k, times a factor
(``hybridid.effects.composed``). Sources: Armstrong-Hélouvry, Dupont, Canudas de Wit (1994), Automatica 30(7)
(friction); Nayfeh, Mook (1979), Nonlinear Oscillations, ch. 2 and 4 (springs); Merritt (1967), Hydraulic
Control Systems, ch. 3 (orifices); Johnson (1985), Contact Mechanics, ch. 4, and Palmgren (1959), Ball and
Roller Bearing Engineering (powers: 3/2 of the depth of a contact, 2/3 of the speed of a bearing); Hunt,
Crossley (1975), J. Applied Mechanics 42(2) (damping that grows with a power of the depth); Wouterse
(1991), IEE Proc. B 138(4) (eddy-current brake); Isermann (2005), Mechatronic Systems, ch. 6 (limits,
backlash, saturation); Fung (1993), Biomechanics, ch. 7 (a stiffness that grows with the force); Tustin
(1947), J. IEE 94(2A), 143-151 (friction that falls with exp(-|v|/s)); Khurmi, Gupta (2005), A Textbook of
Machine Design, ch. 24 (centrifugal clutch: square beyond a gap); Woodson, Melcher (1968), Electromechanical
Dynamics, part I (a magnet's pull, inverse to the square of its gap); Hamrock, Schmid, Jacobson (2004),
Fundamentals of Fluid Film Lubrication (a squeeze film, inverse to the cube of its thickness).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Literal

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.effects.effect import Local
from hybridid.effects.over import BRISTLE, RECENT, RECENT_LOAD, Over
from hybridid.effects.smooth import magnitude
from hybridid.effects.variable import Variable

Array = NDArray[np.float64]
Role = Literal["place", "pole", "width", "period", "share", "exponent", "reference"]
SMOOTH = 1e-3
"""Of its reference: within so much of zero a power is rounded where its port declares no width."""


@dataclass(frozen=True)
class Seen:
    """The variable x of a shape, its modulus ``size`` and its ``sign``, smoothed over the ``width`` that the
    port declares, where it declares one."""

    x: ca.SX
    size: ca.SX
    sign: ca.SX
    width: ca.SX | float | None = None

    def rounded(self, reference: ca.SX) -> ca.SX:
        """``|x|/reference``, never zero: a power below 1 has no slope there. It is rounded over the width of
        the port, as sign(v) is, else over ``SMOOTH``."""
        least = SMOOTH if self.width is None else self.width / reference
        return ca.sqrt((self.x / reference) ** 2 + least**2)


def seen_at(over: Over, at: Local, x: ca.SX) -> Seen:
    """``x``, the variable of ``over`` at a port, as a shape sees it."""
    if over.variable == "velocity":
        return Seen(x, at.speed, at.sign, at.epsilon)
    if over.variable == "load":
        return Seen(x, magnitude(x, at.load_width), ca.tanh(x / at.load_width), at.load_width)
    return Seen(x, ca.fabs(x), ca.sign(x))


@dataclass(frozen=True)
class Shape:
    """One shape: ``amplitudes`` times functions of x; ``roles`` are those of its shape parameters, by name.

    ``equation`` holds ``{x}`` where the variable stands. An amplitude has the unit of the effort, or of what
    the factor multiplies, over that of x to the ``power``; a shape parameter has the unit of x, but for a
    ``share`` and an ``exponent``, which have none. A ``pole`` is a place that x does not reach. A
    ``reference`` is no free parameter: it is the x at which the shape is one, and keeps the unit of an
    amplitude from an exponent. ``suits`` names the variables over which textbooks use the shape.
    """

    name: str
    equation: str
    power: int
    roles: dict[str, Role]
    function: Callable[[Seen, SimpleNamespace], ca.SX]
    suits: tuple[Variable, ...]
    amplitudes: tuple[str, ...] = ("k",)

    def contact(self, over: Over) -> bool:
        """Whether it is the force of a contact over ``over``, or the flow over an edge."""
        return self.name in CONTACTS and over.variable in PLACES and not over.factor

    def finer(self, over: Over) -> bool:
        """Whether it may change faster over ``over`` than any learned effort can: a period may be short; and
        a contact may press so hard that the machine hardly goes beyond the place where it begins."""
        return self.contact(over) or "period" in self.roles.values()

    def values(self, x: Array, point: Mapping[str, float]) -> Array:
        """The shape at ``x`` (n,), its parameters as ``point`` has them."""
        at = ca.DM(x)
        found = self.function(Seen(at, ca.fabs(at), ca.sign(at)), SimpleNamespace(**point))
        return np.asarray(ca.DM(found)).ravel() * np.ones(len(x))

    def __reduce__(self) -> tuple[Callable[[str], Shape], tuple[str]]:
        """Another process finds it by its name: its function cannot be pickled."""
        return shape_named, (self.name,)


def _power_beyond(depth: ca.SX, exponent: ca.SX) -> ca.SX:
    """``depth`` to the power of ``exponent``, zero where it is negative."""
    pressed = ca.fmax(depth, 0)
    return pressed * (pressed**2 + SMOOTH**2) ** ((exponent - 1) / 2)


CONTACTS = ("above", "below", "power_above", "power_below", "beyond_gap")
"""Shapes that are zero up to a place, and rise from there: the force of a contact, over the position."""
PLACES: tuple[Variable, ...] = ("position", "level")
SPEEDS: tuple[Variable, ...] = ("velocity", RECENT)
EFFORTS: tuple[Variable, ...] = ("load", "input")

SHAPES = (
    Shape(
        "proportional", "k {x}", 1, {}, lambda at, p: p.k * at.x,
        ("velocity", *PLACES, "time", *EFFORTS, RECENT, RECENT_LOAD, BRISTLE),
    ),
    Shape("modulus", "k |{x}|", 1, {}, lambda at, p: p.k * at.size, ("velocity", *PLACES, *EFFORTS)),
    Shape("sign", "k sign({x})", 0, {}, lambda at, p: p.k * at.sign, ("velocity",)),
    Shape("square", "k {x}²", 2, {}, lambda at, p: p.k * at.x**2, (*SPEEDS, *PLACES, "time", *EFFORTS)),
    Shape(
        "signed_square", "k {x} |{x}|", 2, {}, lambda at, p: p.k * at.x * at.size,
        ("velocity", *PLACES, *EFFORTS),
    ),
    Shape(
        "cube", "k {x}³", 3, {}, lambda at, p: p.k * at.x**3, ("velocity", *PLACES, *EFFORTS, BRISTLE)
    ),
    Shape(
        "root", "k {x} / √(1 + |{x}|/s)", 1, {"s": "width"},
        lambda at, p: p.k * at.x / ca.sqrt(1 + at.size / p.s), ("velocity", *PLACES, *EFFORTS),
    ),
    Shape(
        "power", "k ({x}/s) |{x}/s|^(n - 1)", 0, {"n": "exponent", "s": "reference"},
        lambda at, p: p.k * (at.x / p.s) * at.rounded(p.s) ** (p.n - 1),
        ("velocity", *PLACES, *EFFORTS),
    ),
    Shape(
        "even_power", "k |{x}/s|^n", 0, {"n": "exponent", "s": "reference"},
        lambda at, p: p.k * at.rounded(p.s) ** p.n, ("velocity", *PLACES, *EFFORTS),
    ),
    Shape(
        "shifted", "k ({x} - c)", 1, {"c": "place"}, lambda at, p: p.k * (at.x - p.c),
        (*PLACES, "time", *EFFORTS, RECENT, RECENT_LOAD),
    ),
    Shape(
        "parabola", "k ({x} - c)²", 2, {"c": "place"}, lambda at, p: p.k * (at.x - p.c) ** 2,
        (*PLACES, "time", *EFFORTS),
    ),
    Shape(
        "shifted_cube", "k ({x} - c)³", 3, {"c": "place"}, lambda at, p: p.k * (at.x - p.c) ** 3, PLACES
    ),
    Shape(
        "above", "k max({x} - c, 0)", 1, {"c": "place"}, lambda at, p: p.k * ca.fmax(at.x - p.c, 0),
        ("velocity", *PLACES, "time", *EFFORTS, RECENT, RECENT_LOAD),
    ),
    Shape(
        "below", "k min({x} - c, 0)", 1, {"c": "place"}, lambda at, p: p.k * ca.fmin(at.x - p.c, 0),
        ("velocity", *PLACES, "time", *EFFORTS),
    ),
    Shape(
        "power_above", "k max(({x} - c)/s, 0)^n", 0, {"c": "place", "n": "exponent", "s": "reference"},
        lambda at, p: p.k * _power_beyond((at.x - p.c) / p.s, p.n), PLACES,
    ),
    Shape(
        "power_below", "k max((c - {x})/s, 0)^n", 0, {"c": "place", "n": "exponent", "s": "reference"},
        lambda at, p: p.k * _power_beyond((p.c - at.x) / p.s, p.n), PLACES,
    ),
    Shape(
        "inverse_power", "k (s/|{x} - c|)^n", 0, {"c": "pole", "n": "exponent", "s": "reference"},
        lambda at, p: p.k * (((at.x - p.c) / p.s) ** 2 + SMOOTH**2) ** (-p.n / 2), PLACES,
    ),
    Shape(
        "beyond_gap", "k ({x} - clip({x}, -s, s))", 1, {"s": "width"},
        lambda at, p: p.k * (at.x - ca.fmin(ca.fmax(at.x, -p.s), p.s)), ("velocity", *PLACES, *EFFORTS),
    ),
    Shape(
        "square_beyond_gap", "k ({x} |{x}| - clip({x} |{x}|, -s², s²))", 2, {"s": "width"},
        lambda at, p: p.k * (at.x * at.size - ca.fmin(ca.fmax(at.x * at.size, -(p.s**2)), p.s**2)),
        ("velocity",),
    ),
    Shape(
        "saturating", "k tanh({x}/s)", 0, {"s": "width"}, lambda at, p: p.k * ca.tanh(at.x / p.s),
        ("velocity", *PLACES, *EFFORTS, RECENT, RECENT_LOAD),
    ),
    Shape(
        "peak", "2 k ({x}/s) / (1 + ({x}/s)²)", 0, {"s": "width"},
        lambda at, p: 2 * p.k * (at.x / p.s) / (1 + (at.x / p.s) ** 2), ("velocity", *EFFORTS),
    ),
    Shape(
        "stribeck", "k sign({x}) exp(-({x}/s)²)", 0, {"s": "width"},
        lambda at, p: p.k * at.sign * ca.exp(-((at.x / p.s) ** 2)), ("velocity",),
    ),
    Shape(
        "tustin", "k sign({x}) exp(-|{x}|/s)", 0, {"s": "width"},
        lambda at, p: p.k * at.sign * ca.exp(-at.size / p.s), ("velocity",),
    ),
    Shape(
        "exponential", "k (1 - exp(-{x}/s))", 0, {"s": "width"},
        lambda at, p: p.k * (1 - ca.exp(-at.x / p.s)), ("time", RECENT),
    ),
    Shape(
        "exponential_rise", "k exp({x}/s)", 0, {"s": "width"}, lambda at, p: p.k * ca.exp(at.x / p.s), PLACES
    ),
    Shape(
        "exponential_decay", "k exp(-{x}/s)", 0, {"s": "width"}, lambda at, p: p.k * ca.exp(-at.x / p.s),
        PLACES,
    ),
    Shape(
        "bump", "k exp(-(({x} - c)/s)²)", 0, {"c": "place", "s": "width"},
        lambda at, p: p.k * ca.exp(-(((at.x - p.c) / p.s) ** 2)), (*PLACES, "time"),
    ),
    Shape(
        "step", "k (1 + tanh(({x} - c)/s))/2", 0, {"c": "place", "s": "width"},
        lambda at, p: p.k * (1 + ca.tanh((at.x - p.c) / p.s)) / 2, (*PLACES, "time", *EFFORTS),
    ),
    Shape(
        "sine", "k_s sin(2π {x}/T) + k_c cos(2π {x}/T)", 0, {"T": "period"},
        lambda at, p: p.k_s * ca.sin(2 * ca.pi * at.x / p.T) + p.k_c * ca.cos(2 * ca.pi * at.x / p.T),
        ("position",), ("k_s", "k_c"),
    ),
)  # fmt: skip
"""The shapes, those without a shape parameter first."""


def shapes_over(variable: Variable) -> tuple[Shape, ...]:
    """The shapes that suit a variable."""
    return tuple(shape for shape in SHAPES if variable in shape.suits)


def shape_named(name: str) -> Shape:
    """The shape called ``name``."""
    return next(shape for shape in SHAPES if shape.name == name)
