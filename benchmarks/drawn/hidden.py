"""``Concealed``: what a drawn scenario hides at one port, as a law of the rig."""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.drawn.draw import Draw, Wanted
from benchmarks.drawn.laws import NAMED
from benchmarks.drawn.recipes import RECIPES, Moving, composed_values
from benchmarks.drawn.shapes import Factor, composed
from benchmarks.league.planting import Hidden
from hybridid.rigs.laws import Law


@dataclass(frozen=True)
class Concealed(Hidden):
    """As the league has it, with the laws of the drawn league; ``factors`` are those of a composed law."""

    factors: tuple[str, ...] = ()

    @property
    def law(self) -> Law:
        if self.factors:
            f, g = factors_of(self.factors)
            return composed(f, g)
        return NAMED[self.what] if self.what in NAMED else super().law


def factors_of(words: tuple[str, ...]) -> tuple[Factor, Factor]:
    """``("direction.velocity", "modulus.load")`` as factors."""
    f, g = (Factor(*word.split(".")) for word in words)
    return f, g


def concealed(draw: Draw, wanted: Wanted, port: str, amount: float, at: Moving) -> Concealed:
    """The law of ``wanted`` at ``port``, of the ``amount`` [effort there]."""
    amount *= wanted.sign
    if wanted.factors:
        values = composed_values(amount, factors_of(wanted.factors), wanted.chances, at)
        return Concealed(wanted.what, port, values, wanted.factors)
    values = RECIPES[wanted.what](amount, wanted.chances, at)
    if wanted.what == "varying_inertia":
        values |= _rest_of_the_machine(draw)
    return Concealed(wanted.what, port, values)


def _rest_of_the_machine(draw: Draw) -> dict[str, float]:
    """Mass and other efforts of a machine of one mass: what its law of a varying inertia must know."""
    p = draw.parameters
    if draw.machine == "oscillator":
        return {"M": p["m"], "f_v": p["d"], "f_c": 0.0, "offset": 0.0, "k": p["k"]}
    return {"M": p["M"], "f_v": p["f_v"], "f_c": p["f_c"], "offset": p["offset"], "k": 0.0}
