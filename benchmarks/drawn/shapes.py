"""``composed``: an effort that no textbook names, F = amplitude f(x) g(y), made of textbook shapes.

f and g are shapes of ``SHAPES``, each over one variable of ``VARIABLES``, moved and scaled:

    x = (variable - place) / scale

The load is the drive's effort, held over a piece of a sample (see ``told``). The acceleration is the rate of
a follower of the velocity, a' = (v - a_v) / tau_a. The travel of late is x' = |v| - x / tau_r.

Law and shapes are one file, because numba's cache does not notice a change in another one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from numba import njit

from hybridid.rigs.laws import Law

VARIABLES = ("position", "velocity", "load", "acceleration", "time", "travel")
SHAPES = (
    "linear", "modulus", "square", "signed_square", "one_sided", "bump", "peak", "saturating", "step", "sine",
    "decay", "growth", "direction", "stribeck",
)  # fmt: skip
DRY = ("direction", "stribeck")


@njit(cache=True)
def _shape(kind, x, s):
    size = abs(x)
    if kind == 0:
        return x
    if kind == 1:
        return size
    if kind == 2:
        return x * x
    if kind == 3:
        return x * size
    if kind == 4:
        return max(x, 0.0)
    if kind == 5:
        return math.exp(-x * x)
    if kind == 6:
        return 2.0 * x / (1.0 + x * x)
    if kind == 7:
        return math.tanh(x)
    if kind == 8:
        return 0.5 * (1.0 + math.tanh(4.0 * x))
    return _further_shape(kind, x, s)


@njit(cache=True)
def _further_shape(kind, x, s):
    if kind == 9:
        return math.sin(2.0 * math.pi * x)
    if kind == 10:
        return math.exp(-x)
    if kind == 11:
        return 1.0 - math.exp(-x)
    if kind == 12:
        return s
    return s * math.exp(-x * x)


@njit(cache=True)
def _variable(kind, q, v, load, a, t, travel):
    if kind == 0:
        return q
    if kind == 1:
        return v
    if kind == 2:
        return load
    if kind == 3:
        return a
    return t if kind == 4 else travel


def _composed(t, q, v, s, z, p, dz):
    # z = velocity of the follower, travel of late
    dz[0] = (v - z[0]) / p[2]
    dz[1] = s * v - z[1] / p[3]
    force = p[0]
    for first in (4, 8):
        value = _variable(int(p[first]), q, v, p[1], dz[0], t, z[1])
        force *= _shape(int(p[first + 1]), (value - p[first + 2]) / p[first + 3], s)
    return force


@dataclass(frozen=True)
class Factor:
    """One factor of a composed law: a shape over a variable, as ``direction.velocity``."""

    shape: str
    variable: str

    def __post_init__(self) -> None:
        if self.shape not in SHAPES or self.variable not in VARIABLES:
            raise ValueError(f"factor {self}: shapes {', '.join(SHAPES)}; over {', '.join(VARIABLES)}")

    def __str__(self) -> str:
        return f"{self.shape}.{self.variable}"

    def numbers(self, of: str, place: float, scale: float) -> dict[str, float]:
        """The law's parameters of the factor ``of`` (``f`` or ``g``)."""
        codes = (VARIABLES.index(self.variable), SHAPES.index(self.shape), place, scale)
        return {f"{of}_{what}": float(x) for what, x in zip(PARTS, codes, strict=True)}


PARTS = ("variable", "shape", "place", "scale")


def composed(f: Factor, g: Factor) -> Law:
    """The law amplitude f g; its values are ``amplitude``, ``load``, ``tau_a``, ``tau_r`` and those of
    ``Factor.numbers``."""
    own = (("amplitude", "N"), ("load", "N"), ("tau_a", "s"), ("tau_r", "s"))
    return Law(
        name=f"{f}*{g}",
        equation=f"F = amplitude {f} {g}",
        function=_composed,
        parameters=(*own, *((f"{of}_{part}", "") for of in "fg" for part in PARTS)),
        states=2,
        dry=any(one.shape in DRY for one in (f, g)),
        positive=("tau_a", "tau_r", "f_scale", "g_scale"),
    )
