"""One-sided contacts: they can push but not pull."""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import ONE, POSITION, STIFFNESS, TIME
from hybridid.effects.effect import Effect, EffectParameter, Local
from hybridid.effects.smooth import pressed, ramp

EDGE = EffectParameter("width", POSITION, "rounding of the contact's edge", guess=1e-4, lower=0.0, fixed=True)


def _stopped(at: Local) -> ca.SX:
    """The effort of a spring and a damper beside each other, beyond a place."""
    beyond = at.p.side * at.position - at.p.d
    damping = at.p.tau * at.velocity * pressed(beyond, at.p.width)
    return at.p.k * (at.p.side * ramp(beyond, at.p.width) + damping)


END_STOP = Effect(
    id="end_stop",
    kind="effort",
    title="elastic end stop, with damping",
    equation="F = k (side ramp(x) + τ v ramp'(x)),  x = side q - d,  ramp(x) = 0 for x < 0, x for x > 0",
    law=_stopped,
    parameters=(
        EffectParameter("k", STIFFNESS, "stiffness of the stop", guess=3.0, lower=0.0, nests=True, hard=True),
        EffectParameter(
            "d",
            POSITION,
            "position of the stop, on its side",
            guess=0.8,
            lower=-5.0,
            upper=5.0,
            starts=(0.3, 2.0),
            sought="place",
        ),
        EffectParameter(
            "tau", TIME, "damping of the stop over its stiffness", guess=0.0, lower=0.0, minor=True
        ),
        EffectParameter(
            "side", ONE, "1: stops motion upwards; -1: downwards", guess=1.0, starts=(-1.0,), fixed=True
        ),
        EDGE,
    ),
    source=(
        "Shaw, Holmes (1983), A periodically forced piecewise linear oscillator, J. Sound Vib. 90(1), 129-155"
        "; the damper: Gilardi, Sharf (2002), Mech. Mach. Theory 37(10), 1213-1239, sec. 4 (Kelvin-Voigt)"
    ),
    pattern="nothing up to one position, then a stiff spring, which takes energy where it is damped",
    look_alikes=("cubic_stiffness", "linear_stiffness", "input_saturation"),
    separating_experiment=(
        "approach the suspected end slowly with a growing command: the motion stops, the effort rises"
    ),
)

WHEEL_LIFT_OFF = Effect(
    id="wheel_lift_off",
    kind="effort",
    title="wheel that lifts off",
    equation=(
        "F = k ramp(-q - d),  so that a tyre k q about its static load k d cannot pull; q > 0 compresses"
    ),
    law=lambda at: at.p.k * ramp(-at.position - at.p.d, at.p.width),
    parameters=(
        EffectParameter(
            "k", STIFFNESS, "stiffness of the tyre, lost in the air", guess=1.0, lower=0.0, nests=True
        ),
        EffectParameter(
            "d",
            POSITION,
            "deflection of the tyre under the static load",
            guess=0.1,
            lower=1e-3,
            upper=5.0,
            starts=(0.02, 0.5),
        ),
        EDGE,
    ),
    source=(
        "Pfeiffer, Glocker (1996), Multibody Dynamics with Unilateral Contacts, Wiley, ch. 5; static load"
        " as in Gillespie (1992), Fundamentals of Vehicle Dynamics, SAE, ch. 5"
    ),
    pattern=(
        "only while the tyre is unloaded below its static load: after a bump or in a dip; one-sided where"
        " a hardening tyre is two-sided"
    ),
    look_alikes=("cubic_stiffness", "asymmetric_damper", "end_stop"),
    separating_experiment=(
        "the same bump at rising speed, until the axle is seen to fly: the effect has a threshold, and "
        "the axle then falls freely"
    ),
    ports=("*tyre*", "*tire*", "*wheel*"),
)
