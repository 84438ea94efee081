"""Saturation, dead zone and speed-dependent limit of a drive."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca

from hybridid.effects.dimension import EFFORT, ONE, VELOCITY, Dimension
from hybridid.effects.effect import Effect, EffectParameter, Local
from hybridid.effects.smooth import ramp, saturated

INVERSE = Dimension(effort=-1)
TINY = 1e-9
"""Keeps the derivative of ``|u|^n`` finite at u = 0 for every n."""


def _clipping(u: ca.SX, inverse_limit: ca.SX, bend: ca.SX) -> ca.SX:
    """``u / (1 + |u/limit|^n)^(1/n) - u`` with n = 1/bend, exactly zero for 1/limit = 0. By logarithms, so
    that no power overflows at a sharp corner."""
    power = ca.log((inverse_limit * u) ** 2 + TINY) / (2 * bend)
    at_nothing = math.log(TINY) / (2 * bend)
    return u * (ca.exp(bend * (_log_of_one_and_exp(at_nothing) - _log_of_one_and_exp(power))) - 1)


def _log_of_one_and_exp(x: ca.SX) -> ca.SX:
    """``log(1 + exp(x))``."""
    return ca.fmax(x, 0) + ca.log(1 + ca.exp(-ca.fabs(x)))


LIMIT = EffectParameter(
    "inverse_limit",
    INVERSE,
    "1 over the largest magnitude that passes",
    guess=0.3,
    lower=0.0,
    upper=100.0,
    starts=(0.1, 1.0),
    nests=True,
)
BEND = EffectParameter(
    "bend",
    ONE,
    "bend: with 0.5 the limit is neared early, as in iron; with 0.001 it clips, as in software",
    guess=0.25,
    lower=1e-3,
    upper=0.5,
    minor=True,
)
"""Above 0.5 the law would bend at u = 0 already: a drive follows small inputs in proportion. At the limit
itself the share ln(2) bend is lost. A sharp corner is near in this parameter; in n = 1/bend it is far away,
where the cost is flat. Below 0.001 a corner lies between two samples of most records, and no derivative shows
where to."""


INPUT_SATURATION = Effect(
    id="input_saturation",
    kind="input",
    title="drive that saturates",
    equation="u → u / (1 + |u/limit|^(1/bend))^bend",
    law=lambda at: _clipping(at.signal, at.p.inverse_limit, at.p.bend),
    parameters=(replace(LIMIT, sought="limit"), BEND),
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
        "overflow",
        "two_sided_load_friction",
        "back_emf_limit",
    ),
    separating_experiment=(
        "the same motion with twice the mass or twice the acceleration: saturation goes with the input's "
        "size, drag with the speed. Against load friction, brake hard: a saturation weakens the braking, "
        "load friction adds to it"
    ),
)

NEAR_NO_LOAD = 0.02
"""Rounding of the share of the limit that the speed leaves: it stays positive beyond the no-load speed."""


def _lacking(at: Local) -> ca.SX:
    ahead = at.velocity * ca.tanh(at.drive / at.load_width)  # positive while the drive drives
    left = ramp(1 - ahead / at.p.v_0, NEAR_NO_LOAD)
    return -_clipping(at.drive, at.p.inverse_limit / left, at.p.bend)


BACK_EMF_LIMIT = Effect(
    id="back_emf_limit",
    kind="effort",
    title="drive whose limit falls with the speed",
    equation="F = drive - drive/(1 + |drive/limit|^(1/bend))^bend,  limit = F_0 (1 - v sign(drive)/v_0)",
    law=_lacking,
    parameters=(
        replace(LIMIT, meaning="1/F_0: 1 over the largest effort at standstill", starts=(1.0,)),
        EffectParameter(
            "v_0", VELOCITY, "no-load speed, at which nothing is left", guess=2.0, lower=0.2, upper=50.0
        ),
        BEND,
    ),
    source=(
        "torque of a motor at full voltage, k_t (V - k_t ω)/R: Duclusaud, Passault, Padois, Ly (2025), IEEE "
        "ICRA, arXiv:2410.08650; as a limit of a drive: NVIDIA PhysX 5.6 (2025), PxPerformanceEnvelope"
    ),
    pattern=(
        "while it drives, the drive gives less than is asked for where both the effort and the speed are "
        "large; while it brakes it gives more. A saturation is the same at every speed"
    ),
    look_alikes=("input_saturation", "quadratic_drag", "load_friction", "viscous"),
    separating_experiment=(
        "full command from standstill up to the highest speed, and full braking from there, at two supply "
        "voltages: the limit falls with the speed on a straight line that the voltage shifts"
    ),
    needs=("drive",),
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
    look_alikes=("coulomb", "stribeck", "input_gain", "input_saturation", "steady_leak"),
    separating_experiment=(
        "coast down with the input at zero, and brake: friction still acts, a dead zone does not"
    ),
)
