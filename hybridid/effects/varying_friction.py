"""Friction whose level varies: with position, over the run, with warmth, between rebound and compression."""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import DAMPING, EFFORT, ONE, POSITION, STIFFNESS, TIME, VELOCITY, Dimension
from hybridid.effects.effect import Effect, EffectParameter, EffectState

EFFORT_RATE = Dimension(effort=1, time=-1)
DAMPING_RATE = Dimension(effort=1, position=-1)

POSITION_FRICTION = Effect(
    id="position_friction",
    kind="effort",
    title="friction whose level depends on position",
    equation="F = slope q sign(v)",
    law=lambda at: at.p.slope * at.position * at.sign,
    parameters=(
        EffectParameter(
            "slope", STIFFNESS, "change of the Coulomb level with position", guess=0.1, nests=True
        ),
    ),
    source=(
        "Armstrong-Hélouvry (1991), Control of Machines with Friction, Kluwer, ch. 4 (position dependence)"
    ),
    pattern=(
        "flips with the direction of motion, as friction does, and its level follows the position; a "
        "spring or cogging does not flip. The level at q = 0 is Coulomb friction's"
    ),
    look_alikes=("linear_stiffness", "cogging", "friction_drift", "coulomb", "position_damping", "detent"),
    separating_experiment=(
        "slow constant-velocity runs over the whole stroke, forwards and backwards: half the difference "
        "between the directions is friction over position, half the sum is spring, cogging and gravity"
    ),
)

# sin and cos need an angle: only at ports in rad
CYCLIC_FRICTION = Effect(
    id="cyclic_friction",
    kind="effort",
    title="friction whose level varies over a turn",
    equation="F = (f_c cos(n q) + f_s sin(n q)) sign(v)",
    law=lambda at: (
        (at.p.f_c * ca.cos(at.p.n * at.position) + at.p.f_s * ca.sin(at.p.n * at.position)) * at.sign
    ),
    parameters=(
        EffectParameter("f_c", EFFORT, "amplitude of the cosine", guess=0.05, nests=True),
        EffectParameter("f_s", EFFORT, "amplitude of the sine", guess=0.05, nests=True),
        EffectParameter(
            "n", ONE, "periods in a turn, fixed: 1 for a wheel or a shaft that is not round, 2 for an oval",
            guess=1.0, lower=1.0, starts=(2.0,), fixed=True,
        ),
    ),
    source=(
        "Armstrong-Hélouvry (1991), Control of Machines with Friction, Kluwer, ch. 4 (position dependence: "
        "gears and bearings that are not round)"
    ),
    pattern=(
        "flips with the direction of motion, and its level is higher on one side of the turn than on the "
        "other. Its mean over a turn is Coulomb friction's; gravity and cogging do not flip"
    ),
    look_alikes=("coulomb", "gravity", "cogging", "position_friction", "cyclic_inertia", "load_friction"),
    separating_experiment=(
        "slow turns at a constant speed in both directions: half the difference between the directions is "
        "friction over the angle, half the sum is gravity and cogging"
    ),
    position_units=("rad",),
)  # fmt: skip

FRICTION_BEYOND_GAP = Effect(
    id="friction_beyond_gap",
    kind="effort",
    position_units=("*m", "rad"),  # a clearance is a place in a mechanism: a voltage has none
    title="friction beyond a gap",
    equation="F = f_c sign(v) where |q| > g, rounded: (1 + tanh((|q| - g)/width))/2",
    law=lambda at: at.p.f_c * at.sign * 0.5 * (1 + ca.tanh((ca.fabs(at.position) - at.p.g) / at.p.width)),
    parameters=(
        EffectParameter("f_c", EFFORT, "friction level beyond the gap", guess=0.1, lower=0.0, nests=True),
        EffectParameter(
            "g", POSITION, "half the gap: where the friction begins, on both sides", guess=0.3, lower=1e-3,
            upper=5.0, starts=(0.1, 0.7), sought="place",
        ),
        EffectParameter("width", POSITION, "rounding of the gap's edges", guess=5e-3, lower=0.0, fixed=True),
    ),
    source=(
        "rubbing once a clearance is crossed: Muszynska (2005), Rotordynamics, CRC Press, ch. 5; Pfeiffer, "
        "Glocker (1996), Multibody Dynamics with Unilateral Contacts, Wiley, ch. 5"
    ),
    pattern=(
        "none within the gap about q = 0, then dry friction on both sides of it, whichever way the port "
        "moves. A play travels with the port, and the friction behind it depends on where it turned. In a "
        "swing that decays it grows with the amplitude, as drag does"
    ),
    look_alikes=(
        "friction_behind_play", "position_friction", "position_damping", "coulomb", "end_stop",
        "quadratic_drag",
    ),
    separating_experiment=(
        "slow strokes of growing amplitude about the middle: within the gap the loop of effort over position "
        "has no area; beyond it the area grows in proportion to what the stroke exceeds the gap by"
    ),
)  # fmt: skip

FRICTION_DRIFT = Effect(
    id="friction_drift",
    kind="effort",
    title="friction that drifts over the run",
    equation="F = t (r_c sign(v) + r_v v)",
    law=lambda at: at.time * (at.p.r_c * at.sign + at.p.r_v * at.velocity),
    parameters=(
        EffectParameter("r_c", EFFORT_RATE, "drift of the Coulomb level", guess=0.001, nests=True),
        EffectParameter("r_v", DAMPING_RATE, "drift of the viscous coefficient", guess=0.001, nests=True),
    ),
    source=(
        "Bittencourt, Gunnarsson (2012), ASME J. Dyn. Syst. Meas. Control 134(5), 051013 (friction over "
        "temperature), to first order in time"
    ),
    pattern=(
        "friction that is higher or lower at the end of the record than at its beginning, at the same motion"
    ),
    look_alikes=("position_friction", "coulomb", "viscous", "warming_friction"),
    separating_experiment="repeat one short motion from cold to warm and return to where it began in between",
)

WARMING_FRICTION = Effect(
    id="warming_friction",
    kind="effort",
    title="friction that falls as the contact warms",
    equation="F = -b w sign(v),  w' = (|v| - w)/τ",
    law=lambda at: -at.p.b * at.z.w * at.sign,
    dynamics=lambda at: {"w": (at.speed - at.z.w) / at.p.tau},
    parameters=(
        EffectParameter(
            "b", DAMPING, "fall of the Coulomb level over the recent mean speed", guess=0.1, nests=True
        ),
        EffectParameter(
            "tau",
            TIME,
            "time constant τ of warming and cooling",
            guess=5.0,
            lower=0.2,
            upper=3600.0,
            starts=(1.0, 50.0),
            absolute=True,
        ),
    ),
    states=(EffectState("w", VELOCITY, "recent mean speed: a measure of the contact's temperature"),),
    source=(
        "Bittencourt, Gunnarsson (2012), ASME J. Dyn. Syst. Meas. Control 134(5), 051013 (friction over "
        "temperature); the temperature of one thermal mass that friction heats in proportion to the speed: "
        "Incropera, DeWitt (2007), Fundamentals of Heat and Mass Transfer, 6th ed., ch. 5"
    ),
    pattern=(
        "friction is high after a rest and falls while the machine works, and recovers in a pause; a drift "
        "does not recover"
    ),
    look_alikes=("friction_drift", "coulomb", "viscous", "asymmetric_viscous"),
    separating_experiment=(
        "one short motion repeated until nothing changes, a pause, and the same motion again: friction is as"
        " high as at the beginning, and how much depends on the pause"
    ),
)

ASYMMETRIC_DAMPER = Effect(
    id="asymmetric_damper",
    kind="effort",
    title="damper that differs between rebound and compression",
    equation="F = -(dc/2) (√(v² + v_k²) - v_k),  dc = c(v<0) - c(v>0) well above v_k",
    law=lambda at: -0.5 * at.p.dc * (ca.sqrt(at.velocity**2 + at.p.v_k**2) - at.p.v_k),
    parameters=(
        EffectParameter(
            "dc", DAMPING, "damping in rebound (v < 0) minus in compression (v > 0)", guess=0.2, nests=True
        ),
        EffectParameter(
            "v_k",
            VELOCITY,
            "knee: below it a bleed orifice serves both directions alike",
            guess=0.05,
            lower=1e-3,
            upper=3.0,
            starts=(0.005, 0.5),
        ),
    ),
    source=(
        "Dixon (2007), The Shock Absorber Handbook, 2nd ed., ch. 5 to 7; Duym, Stiens, Reybrouck (1997), "
        "Vehicle System Dynamics 27(2), 109-127"
    ),
    pattern=(
        "even in velocity, flat at low speed where only the bleed orifice works, linear in speed above "
        "the knee; asymmetric viscous friction has its kink at zero"
    ),
    look_alikes=("asymmetric_viscous", "quadratic_drag", "offset", "blow_off_valve"),
    separating_experiment=(
        "sine sweeps of the deflection at peak velocities from a tenth to ten times the knee: the "
        "asymmetry must vanish at the low end"
    ),
    ports=("*suspension*", "*damper*", "*absorber*", "*strut*"),
)
