"""Friction with memory: bristles that bend before they slip.

The state is the deflection of the bristles divided by its largest value: it is dimensionless and bounded.
The laws use the exact ``|v|``, which is Lipschitz. With a smoothed one, a bristle would creep at rest or
exceed its limit.
"""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import EFFORT, ONE, POSITION, TIME, VELOCITY
from hybridid.effects.effect import Effect, EffectParameter, EffectState, Local

# At most the stroke: a bristle with a longer memory acts as a spring. The port's scale only guesses the
# stroke, so no shorter bound may refuse a friction whose memory is long.
LENGTH = EffectParameter(
    "s",
    POSITION,
    "pre-sliding length: friction level over initial stiffness, s = f_c/σ0",
    guess=2e-3,
    lower=1e-5,
    upper=1.0,
    starts=(2e-4, 2e-2),
)
LEVEL = EffectParameter("f_c", EFFORT, "friction level of steady sliding", guess=0.1, lower=0.0, nests=True)

DAHL = Effect(
    id="dahl",
    kind="effort",
    title="Dahl friction",
    equation="F = f_c z,  s z' = v - |v| z,  s = f_c/σ0",
    law=lambda at: at.p.f_c * at.z.z,
    dynamics=lambda at: {"z": (at.velocity - ca.fabs(at.velocity) * at.z.z) / at.p.s},
    parameters=(LEVEL, LENGTH),
    states=(EffectState("z", ONE, "bristle deflection over its largest", lower=-1.0, upper=1.0),),
    source=(
        "thesis Eqs. 5-7 and 5-8; Dahl (1968), A solid friction model, Aerospace Corporation "
        "TOR-0158(3107-18)-1; Dahl (1976), AIAA Journal 14(12), 1675-1682"
    ),
    pattern=(
        "after each reversal the friction builds up over a travel of about s, whatever the speed; Coulomb"
        " friction jumps, Stribeck friction depends on the speed"
    ),
    look_alikes=(
        "coulomb",
        "stribeck",
        "lugre",
        "bouc_wen",
        "maxwell",
        "friction_behind_play",
        "hardening_hysteresis",
    ),
    separating_experiment=(
        "reversals of amplitudes from a tenth to ten times s, slow and fast: hysteresis loops that depend"
        " on travel and not on speed"
    ),
)


def _lugre_rate(at: Local) -> ca.SX:
    """``s z' = v - |v| z / g``, with g the sliding friction over f_c, from 1 + r at rest down to 1."""
    sliding = 1 + at.p.r_s * ca.exp(-((at.velocity / at.p.v_s) ** 2))
    return (at.velocity - ca.fabs(at.velocity) * at.z.z / sliding) / at.p.s


LUGRE = Effect(
    id="lugre",
    kind="effort",
    title="LuGre friction",
    equation=(
        "F = f_c (z + τ_b z'),  s z' = v - |v| z / g(v),  g = 1 + r_s exp(-(v/v_s)²);  σ0 = f_c/s, σ1 = "
        "f_c τ_b/s, f_s = f_c (1 + r_s)"
    ),
    law=lambda at: at.p.f_c * (at.z.z + at.p.tau_b * _lugre_rate(at)),
    dynamics=lambda at: {"z": _lugre_rate(at)},
    parameters=(
        LEVEL,
        LENGTH,
        EffectParameter(
            "tau_b",
            TIME,
            "damping time of the bristles, τ_b = σ1/σ0",
            guess=2e-3,
            lower=0.0,
            upper=0.1,
            minor=True,
        ),
        EffectParameter(
            "r_s", ONE, "static above sliding friction, f_s/f_c - 1", guess=0.3, lower=0.0, upper=5.0
        ),
        EffectParameter(
            "v_s", VELOCITY, "Stribeck velocity", guess=0.1, lower=0.01, upper=2.0, starts=(0.03,)
        ),
    ),
    states=(EffectState("z", ONE, "bristle deflection over that of steady sliding", lower=-6.0, upper=6.0),),
    source=(
        "thesis Eqs. 5-9 and 5-10 with the decaying sign of the exponent (printed growing), its viscous "
        "term being the effect viscous; Canudas de Wit, Olsson, Åström, Lischinsky (1995), IEEE Trans. "
        "Automatic Control 40(3), 419-425"
    ),
    pattern=(
        "Dahl's build-up after a reversal, and Stribeck's fall with speed in one; break-away that depends"
        " on how fast the effort rises"
    ),
    look_alikes=("dahl", "stribeck", "coulomb", "bouc_wen"),
    separating_experiment=(
        "small reversals inside the pre-sliding length, and constant-velocity runs through the Stribeck "
        "velocity: both the loop and the falling branch must show"
    ),
)
