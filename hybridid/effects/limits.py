"""Saturation and dead zone of a drive."""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import EFFORT, ONE, Dimension
from hybridid.effects.effect import Effect, EffectParameter, Local
from hybridid.effects.smooth import saturated

INVERSE = Dimension(effort=-1)
TINY = 1e-9
"""Keeps the derivative of ``|u|^n`` finite at u = 0 for every n."""


def _clipped(at: Local) -> ca.SX:
    """``u / (1 + |u/limit|^n)^(1/n) - u``, exactly zero for 1/limit = 0."""
    n = at.p.n
    load = ((at.p.inverse_limit * at.signal) ** 2 + TINY) ** (n / 2) - TINY ** (n / 2)
    return at.signal * ((1 + load) ** (-1 / n) - 1)


INPUT_SATURATION = Effect(
    id="input_saturation",
    kind="input",
    title="drive that saturates",
    equation="u → u / (1 + |u/limit|^n)^(1/n)",
    law=_clipped,
    parameters=(
        EffectParameter(
            "inverse_limit",
            INVERSE,
            "1 over the largest magnitude that passes",
            guess=0.3,
            lower=0.0,
            upper=100.0,
            starts=(0.1, 1.0),
            nests=True,
        ),
        EffectParameter(
            "n",
            ONE,
            "sharpness, fixed: 2 bends early, 12 clips",
            guess=4.0,
            lower=1.0,
            fixed=True,
        ),
    ),
    source=(
        "Tao, Kokotović (1996), Adaptive Control of Systems with Actuator and Sensor Nonlinearities, "
        "Wiley, ch. 1"
    ),
    pattern="large inputs do less than their share, small ones nothing unusual; odd in the input",
    look_alikes=(
        "load_friction",
        "input_gain",
        "quadratic_drag",
        "input_dead_zone",
        "end_stop",
        "two_sided_load_friction",
    ),
    separating_experiment=(
        "the same motion with twice the mass or twice the acceleration: saturation goes with the input's "
        "size, drag with the speed. Against load friction, brake hard: a saturation weakens the braking, "
        "load friction adds to it"
    ),
)

INPUT_DEAD_ZONE = Effect(
    id="input_dead_zone",
    kind="input",
    title="dead zone of the drive",
    equation="u → u - sat(u, d): 0 within ±d",
    law=lambda at: -saturated(at.signal, at.p.d, at.p.width),
    parameters=(
        EffectParameter(
            "d",
            EFFORT,
            "half the dead zone",
            guess=0.1,
            lower=0.0,
            upper=10.0,
            starts=(0.01, 0.5),
            nests=True,
        ),
        EffectParameter(
            "width", EFFORT, "rounding of the dead zone's edges", guess=1e-3, lower=0.0, fixed=True
        ),
    ),
    source=(
        "Tao, Kokotović (1996), Adaptive Control of Systems with Actuator and Sensor Nonlinearities, "
        "Wiley, ch. 1"
    ),
    pattern=(
        "a loss that follows the sign of the input; Coulomb friction follows the sign of the velocity, "
        "and brakes where a dead zone does not"
    ),
    look_alikes=("coulomb", "stribeck", "input_gain", "input_saturation"),
    separating_experiment=(
        "coast down with the input at zero, and brake: friction still acts, a dead zone does not"
    ),
)
