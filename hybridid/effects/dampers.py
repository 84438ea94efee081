"""Dampers and brakes whose force is no straight line over the velocity, or depends on position."""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import DAMPING, DRAG, EFFORT, VELOCITY, VELOCITY_SQUARED, Dimension
from hybridid.effects.effect import Effect, EffectParameter, Local
from hybridid.effects.smooth import dead_zone

DAMPING_GRADIENT = Dimension(effort=1, position=-2, time=1)


def _eddy(at: Local) -> ca.SX:
    ratio = at.velocity / at.p.v_c
    return 2 * at.p.F_m * ratio / (1 + ratio**2)


EDDY_BRAKE = Effect(
    id="eddy_brake",
    kind="effort",
    title="eddy current brake",
    equation="F = 2 F_m (v/v_c) / (1 + (v/v_c)²)",
    law=_eddy,
    parameters=(
        EffectParameter("F_m", EFFORT, "largest braking effort, at v_c", guess=0.1, lower=0.0, nests=True),
        EffectParameter(
            "v_c", VELOCITY, "critical velocity", guess=0.5, lower=0.02, upper=10.0, starts=(0.1, 2.0)
        ),
    ),
    source=(
        "Wouterse (1991), Critical torque and speed of eddy current brake with widely separated soft iron "
        "poles, IEE Proceedings B 138(4)"
    ),
    pattern=(
        "viscous at low speed, strongest at the critical velocity, and weaker beyond; no step at reversal, "
        "where Stribeck friction has one"
    ),
    look_alikes=("viscous", "stribeck", "coulomb", "quadratic_drag"),
    separating_experiment=(
        "constant-velocity runs from a tenth to ten times the critical velocity, with the magnet on and off:"
        " the effort rises in proportion, and falls again"
    ),
)

CENTRIFUGAL_BRAKE = Effect(
    id="centrifugal_brake",
    kind="effort",
    title="centrifugal brake",
    equation="F = k (v² - v_0²) sign(v) where |v| > v_0, else 0",
    law=lambda at: at.p.k * dead_zone(at.velocity * at.speed, at.p.v_0**2, at.p.width),
    parameters=(
        EffectParameter(
            "k", DRAG, "braking effort over the square of the velocity", guess=0.1, lower=0.0, nests=True
        ),
        EffectParameter(
            "v_0",
            VELOCITY,
            "velocity at which the shoes touch",
            guess=0.5,
            lower=0.02,
            upper=10.0,
            starts=(0.1, 2.0),
        ),
        EffectParameter(
            "width",
            VELOCITY_SQUARED,
            "rounding of the velocity squared where the shoes touch",
            guess=1e-3,
            lower=0.0,
            fixed=True,
        ),
    ),
    source=(
        "shoes that springs hold until their centrifugal force exceeds the preload: Khurmi, Gupta (2005), A "
        "Textbook of Machine Design, 14th ed., ch. 24 (centrifugal clutch)"
    ),
    pattern=(
        "nothing up to one speed, alike in both directions, and steeper than in proportion beyond it; "
        "quadratic drag acts at every speed"
    ),
    look_alikes=("quadratic_drag", "viscous", "blow_off_valve"),
    separating_experiment=(
        "coasting from the highest speed allowed: the deceleration falls with the speed squared, and changes "
        "no more below the speed at which the shoes lift off"
    ),
)

POSITION_DAMPING = Effect(
    id="position_damping",
    kind="effort",
    title="damping that depends on position",
    equation="F = c_q q v",
    law=lambda at: at.p.c_q * at.position * at.velocity,
    parameters=(
        EffectParameter(
            "c_q", DAMPING_GRADIENT, "change of the viscous coefficient with position", guess=0.1, nests=True
        ),
    ),
    source=(
        "Dixon (2007), The Shock Absorber Handbook, 2nd ed., ch. 7 (damper characteristics), to first "
        "order in the position"
    ),
    pattern=(
        "flips with the direction and grows with the speed, on one side of the stroke more than on the "
        "other; position-dependent friction is the same at every speed"
    ),
    look_alikes=("position_friction", "viscous", "quadratic_drag", "friction_drift", "varying_inertia"),
    separating_experiment=(
        "constant-velocity runs over the whole stroke at three speeds in both directions: half the "
        "difference of the directions, over the speed, is one straight line over position"
    ),
)

BLOW_OFF_VALVE = Effect(
    id="blow_off_valve",
    kind="effort",
    title="blow-off valve of a damper",
    equation="F = -dc (v - sat(v, v_b)): a damper that loses dc of its coefficient beyond ±v_b",
    law=lambda at: -at.p.dc * dead_zone(at.velocity, at.p.v_b, at.p.width),
    parameters=(
        EffectParameter(
            "dc",
            DAMPING,
            "damping that is lost while the valve is open; negative stiffens",
            guess=0.2,
            nests=True,
        ),
        EffectParameter(
            "v_b",
            VELOCITY,
            "velocity at which the valve opens",
            guess=0.5,
            lower=0.01,
            upper=3.0,
            starts=(0.1, 1.5),
        ),
        EffectParameter(
            "width", VELOCITY, "rounding of the valve's opening", guess=1e-3, lower=0.0, fixed=True
        ),
    ),
    source="Dixon (2007), The Shock Absorber Handbook, 2nd ed., ch. 6 (valve design, blow-off)",
    pattern=(
        "a damper's force grows less steeply beyond one velocity, alike in both directions; an asymmetric "
        "damper differs between them"
    ),
    look_alikes=("asymmetric_damper", "quadratic_drag", "viscous", "eddy_brake"),
    separating_experiment=(
        "sine sweeps of the deflection at peak velocities from a tenth to ten times the knee: force over "
        "velocity is two straight lines in either direction"
    ),
    ports=("*suspension*", "*damper*", "*absorber*", "*strut*"),
)
