"""Friction that depends on the sliding velocity alone: memoryless."""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import DAMPING, DRAG, EFFORT, VELOCITY
from hybridid.effects.effect import Effect, EffectParameter

_ARMSTRONG = "Armstrong-Hélouvry, Dupont, Canudas de Wit (1994), Automatica 30(7), 1083-1138"

OFFSET = Effect(
    id="offset",
    kind="effort",
    title="constant offset",
    equation="F = offset",
    law=lambda at: at.p.offset,
    parameters=(
        EffectParameter("offset", EFFORT, "constant effort, present at rest too", guess=0.0, nests=True),
    ),
    source="thesis Eq. 6-1; Janot, Gautier, Brunot (2019), Eq. (1)",
    pattern=(
        "the same in both directions of motion and at rest; asymmetric Coulomb friction vanishes at rest, "
        "and a motion in one direction alone does not tell it from Coulomb friction"
    ),
    look_alikes=("asymmetric_coulomb", "coulomb", "gravity", "linear_stiffness", "maxwell"),
    separating_experiment=(
        "hold still under slowly rising command from both sides until break-away, at several positions: "
        "an offset shifts both break-away efforts alike and everywhere, also at rest"
    ),
)

VISCOUS = Effect(
    id="viscous",
    kind="effort",
    title="viscous friction",
    equation="F = f_v v",
    law=lambda at: at.p.f_v * at.velocity,
    parameters=(
        EffectParameter("f_v", DAMPING, "viscous friction coefficient", guess=0.5, lower=0.0, nests=True),
    ),
    source="thesis Eqs. 5-5 and 6-2",
    pattern="proportional to the velocity, odd; quadratic drag bends upwards",
    look_alikes=("quadratic_drag", "coulomb", "maxwell", "eddy_brake", "back_emf_limit"),
    separating_experiment=(
        "constant-velocity runs at five speeds over a decade, in both directions: effort over speed is a "
        "straight line through the origin"
    ),
)

COULOMB = Effect(
    id="coulomb",
    kind="effort",
    title="Coulomb friction",
    equation="F = f_c sign(v), sign(v) ≈ tanh(v/ε)",
    law=lambda at: at.p.f_c * at.sign,
    parameters=(EffectParameter("f_c", EFFORT, "Coulomb friction level", guess=0.3, lower=0.0, nests=True),),
    source="thesis Eq. 6-2; " + _ARMSTRONG,
    pattern="a step where the velocity changes sign, flat elsewhere",
    look_alikes=("stribeck", "dahl", "lugre", "bouc_wen", "input_dead_zone", "load_friction"),
    separating_experiment=(
        "slow reversals of a small amplitude and constant-velocity runs: the step is as sharp in position"
        " as the sensor can see, and its height is the same at every speed"
    ),
)

STRIBECK = Effect(
    id="stribeck",
    kind="effort",
    title="Stribeck friction",
    equation="F = df_s exp(-(v/v_s)²) sign(v),  df_s = f_s - f_c",
    law=lambda at: at.p.df_s * ca.exp(-((at.velocity / at.p.v_s) ** 2)) * at.sign,
    parameters=(
        EffectParameter(
            "df_s", EFFORT, "static above Coulomb level, f_s - f_c", guess=0.1, lower=0.0, nests=True
        ),
        EffectParameter(
            "v_s", VELOCITY, "Stribeck velocity", guess=0.1, lower=0.01, upper=2.0, starts=(0.03, 0.3)
        ),
    ),
    source="thesis Eq. 5-6 with the decaying sign of the exponent (printed growing); " + _ARMSTRONG,
    pattern=(
        "friction falls with speed just after break-away, then levels; with a v_s near the largest speed it "
        "bends as a drag does"
    ),
    look_alikes=("coulomb", "dahl", "lugre", "input_delay", "input_lag", "load_stribeck", "quadratic_drag"),
    separating_experiment=(
        "constant-velocity runs in both directions at ten speeds, logarithmically spaced from far below "
        "to far above v_s: the falling branch shows without acceleration, delay or pre-sliding"
    ),
)

ASYMMETRIC_VISCOUS = Effect(
    id="asymmetric_viscous",
    kind="effort",
    title="viscous friction that differs by direction",
    equation="F = -(df_v/2) |v|,  df_v = f_v(v<0) - f_v(v>0)",
    law=lambda at: -0.5 * at.p.df_v * at.speed,
    parameters=(
        EffectParameter(
            "df_v", DAMPING, "viscous coefficient backwards minus forwards, Fv- - Fv+", guess=0.0, nests=True
        ),
    ),
    source="Janot, Gautier, Brunot (2019), Eq. (12); Janot, Gautier, Young (2017), Int. J. Control 90(4)",
    pattern="even in velocity and linear in speed; quadratic drag is odd, offset does not grow with speed",
    look_alikes=("asymmetric_coulomb", "offset", "asymmetric_damper", "varying_inertia"),
    separating_experiment=(
        "constant-velocity runs at several speeds in both directions over one stretch: the difference "
        "between the directions grows in proportion to the speed"
    ),
)

ASYMMETRIC_COULOMB = Effect(
    id="asymmetric_coulomb",
    kind="effort",
    title="Coulomb friction that differs by direction",
    equation="F = -(df_c/2) sign(v)²,  df_c = f_c(v<0) - f_c(v>0)",
    law=lambda at: -0.5 * at.p.df_c * at.sign**2,
    parameters=(
        EffectParameter(
            "df_c", EFFORT, "Coulomb level backwards minus forwards, Fc- - Fc+", guess=0.0, nests=True
        ),
    ),
    source="Janot, Gautier, Brunot (2019), Eq. (12)",
    pattern="constant while sliding, the same sign in both directions, zero at rest; an offset stays at rest",
    look_alikes=("offset", "asymmetric_viscous", "gravity"),
    separating_experiment=(
        "long rests under a small command between slow runs in both directions: an offset acts, or is "
        "carried by stiction, at rest as well; at several speeds the difference between the directions "
        "stays the same"
    ),
)

QUADRATIC_DRAG = Effect(
    id="quadratic_drag",
    kind="effort",
    title="quadratic drag",
    equation="F = c_d v |v|",
    law=lambda at: at.p.c_d * at.velocity * at.speed,
    parameters=(  # a negative drag would drive the machine
        EffectParameter("c_d", DRAG, "drag coefficient", guess=0.1, lower=0.0, nests=True),
    ),
    source="Batchelor (1967), An Introduction to Fluid Dynamics, sec. 5.11",
    pattern="odd in velocity and growing with its square",
    look_alikes=("viscous", "coulomb", "stribeck", "eddy_brake", "centrifugal_brake", "back_emf_limit"),
    separating_experiment=(
        "constant-velocity runs up to the highest speed allowed: effort over speed squared is a straight "
        "line there, where viscous friction is left behind"
    ),
)
