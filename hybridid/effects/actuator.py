"""Characteristic and slew rate of an actuator: what it gives for a command, and how fast.

Without a limit the rate is infinite, and so is the pole of ``z' = rate tanh((u - z)/(rate floor))``. Here the
increment is ``(r/r_e) (z - u)``, r = 1/rate, with ``z' = tanh(r_e (u - z)/floor)/r_e`` and
``r_e = √(r² + (floor/size)²)``. It is smooth in r, exactly zero at r = 0, and the rate limit for r well above
floor/size.
"""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import EFFORT, Dimension
from hybridid.effects.effect import Effect, EffectParameter, EffectState, Local
from hybridid.effects.paths import FLOOR, SETTLED
from hybridid.effects.sensors import QUADRATIC

INVERSE_RATE = Dimension(effort=-1, time=1)

INPUT_NONLINEARITY = Effect(
    id="input_nonlinearity",
    kind="input",
    title="actuator whose characteristic is bent",
    equation="u → u + c u |u|",
    law=lambda at: at.p.c * at.signal * ca.fabs(at.signal),
    parameters=(
        EffectParameter("c", QUADRATIC, "how much the gain grows with the input", guess=0.05, nests=True),
    ),
    source=(
        "Hammerstein model: Ljung (1999), System Identification, 2nd ed., sec. 5.2; characteristic of a "
        "control valve: Seborg, Edgar, Mellichamp (2004), Process Dynamics and Control, 2nd ed., sec. 9.2"
    ),
    pattern=(
        "the gain grows or falls with the size of the input, alike in both directions: a valve, a pump, a "
        "lamp, a motor whose iron saturates. A saturation leaves small inputs as they are"
    ),
    look_alikes=(
        "input_gain",
        "input_saturation",
        "input_dead_zone",
        "back_emf_limit",
        "load_friction",
        "two_sided_load_friction",
        "steady_leak",
    ),
    separating_experiment=(
        "hold five inputs over the whole range until the machine is steady, and measure what the actuator "
        "gives at each: the curve is the same at every speed and level of the machine"
    ),
)


def _steepness(at: Local) -> ca.SX:
    """1 over the rate: that of the command where the limit is absent, up to one scale within the floor."""
    return ca.sqrt(at.p.inverse_rate**2 + (at.p.floor / at.p.size) ** 2)


def _limited(at: Local) -> ca.SX:
    return at.p.inverse_rate / _steepness(at) * (at.z.z - at.signal)


def _slew(at: Local) -> dict[str, ca.SX]:
    steepness = _steepness(at)
    return {"z": ca.tanh(steepness * (at.signal - at.z.z) / at.p.floor) / steepness}


INPUT_RATE_LIMIT = Effect(
    id="input_rate_limit",
    kind="input",
    title="actuator whose rate is limited",
    equation="u → z,  z' = rate tanh((u - z)/(rate floor)): |z'| ≤ rate,  z(0) = settled u(0)",
    law=_limited,
    dynamics=_slew,
    parameters=(
        EffectParameter(
            "inverse_rate",
            INVERSE_RATE,
            "1 over the largest rate of change that passes",
            guess=0.1,
            lower=0.0,
            upper=100.0,
            starts=(0.02, 1.0),
            nests=True,
        ),
        FLOOR,
        EffectParameter("size", EFFORT, "a typical change of the input, fixed", guess=1.0, fixed=True),
        SETTLED,
    ),
    states=(EffectState("z", EFFORT, "what the actuator gives", follows=SETTLED.name),),
    source=(
        "Hess, Snell (1997), Flight control system design with rate saturating actuators, J. Guidance, "
        "Control, and Dynamics 20(1), 90-96; its floor as in hybridid.effects.paths"
    ),
    pattern=(
        "large and fast changes of the input arrive late, as ramps of one slope; small and slow ones pass. A "
        "lag delays all alike"
    ),
    look_alikes=("input_lag", "input_delay", "input_saturation", "back_emf_limit"),
    separating_experiment=(
        "steps of the command of one tenth, a half and the whole range: behind a rate limit the time to "
        "arrive grows with the step, behind a lag it does not"
    ),
)
