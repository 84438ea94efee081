"""A supply that brings less where the level is high: q is the level, or how much warmer than around it is."""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import POSITION, Dimension
from hybridid.effects.effect import Effect, EffectParameter, Local


def _lost(at: Local) -> ca.SX:
    share = at.p.a * at.position
    return at.drive * share / (1 + at.p.a * ca.sqrt(at.position**2 + at.p.width**2))


FALLING_SUPPLY = Effect(
    id="falling_supply",
    kind="flow",
    title="supply that falls with the level",
    equation="F = supply a q/(1 + a |q|),  |q| ≈ √(q² + w²)",
    law=_lost,
    parameters=(
        EffectParameter(
            "a",
            Dimension(position=-1),
            "rise of the resistance with q, over that at q = 0; the share of a pump's flow that is lost",
            guess=0.03,
            lower=0.0,
            nests=True,
        ),
        EffectParameter("width", POSITION, "rounding w at q = 0", guess=1e-3, lower=0.0, fixed=True),
    ),
    source=(
        "a heating wire at constant voltage, whose resistance grows as 1 + a q: Halliday, Resnick, Walker "
        "(2013), Fundamentals of Physics, 10th ed., sec. 26-3; a pump that delivers less against a higher "
        "head: White (2011), Fluid Mechanics, 7th ed., sec. 11.2"
    ),
    pattern=(
        "a loss in proportion to the supply that grows with the level: with the supply off nothing is missing"
    ),
    look_alikes=(
        "linear_leak",
        "natural_convection",
        "thermal_radiation",
        "input_gain",
        "sensor_nonlinearity",
    ),
    separating_experiment=(
        "switch the supply off at a high level, and record how that falls: a leak or a loss to the "
        "surroundings is there too, this one is not"
    ),
    needs=("drive",),
)
