"""Friction with memory: bristles that bend before they slip.

The state is the deflection of the bristles divided by its largest value: it is dimensionless and bounded.
The laws use the exact ``|v|``, which is Lipschitz. With a smoothed one, a bristle would creep at rest or
exceed its limit.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from hybridid.effects.dimension import EFFORT, ONE, POSITION, TIME, VELOCITY
from hybridid.effects.effect import Effect, EffectParameter, EffectState, Local

TINY = 1e-12
"""Keeps the derivative of ``|z|^n`` finite at z = 0 for every n."""


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


def _power(x: ca.SX, exponent: ca.SX) -> ca.SX:
    """``|x|^n``, differentiable in n at x = 0 too."""
    return (x**2 + TINY) ** (exponent / 2)


def _bouc_wen_rate(at: Local) -> ca.SX:
    v, z, n, sigma = at.velocity, at.z.z, at.p.n, at.p.sigma
    slip = sigma * ca.fabs(v) * _power(z, n - 1) * z - (sigma - 1) * v * _power(z, n)
    return (v - slip) / at.p.s


BOUC_WEN = Effect(
    id="bouc_wen",
    kind="effort",
    title="Bouc-Wen hysteresis",
    equation="F = f_c z,  s z' = v - σ |v| |z|^(n-1) z + (σ - 1) v |z|^n",
    law=lambda at: at.p.f_c * at.z.z,
    dynamics=lambda at: {"z": _bouc_wen_rate(at)},
    parameters=(
        LEVEL,
        replace(LENGTH, upper=1.0, guess=0.02, starts=(2e-4, 2e-3, 0.2)),
        EffectParameter(
            "sigma",
            ONE,
            "σ: 1/2 unloads elastically, 1 with n = 1 is Dahl's",
            guess=0.7,
            lower=0.5,
            upper=5.0,
            minor=True,
        ),
        EffectParameter(
            "n",
            ONE,
            "sharpness of the yield, fixed: 1 as Dahl's, 10 nearly elastic-plastic",
            guess=2.0,
            lower=1.0,
            upper=20.0,
            fixed=True,
        ),
    ),
    states=(EffectState("z", ONE, "hysteretic deflection over its largest", lower=-1.0, upper=1.0),),
    source=(
        "Wen (1976), ASCE J. Engineering Mechanics Division 102(2), 249-263; normalised as in Ikhouane, "
        "Rodellar (2007), Systems with Hysteresis, Wiley, ch. 2. Its spring in parallel is the effect "
        "linear_stiffness"
    ),
    pattern=(
        "a hysteresis loop that depends on travel and not on speed, and yields over a rounded knee: a "
        "rubber or a joint that slips a little before it slides"
    ),
    look_alikes=(
        "dahl",
        "coulomb",
        "lugre",
        "maxwell",
        "cubic_stiffness",
        "friction_behind_play",
        "hardening_hysteresis",
    ),
    separating_experiment=(
        "quasi-static loops of growing amplitude with partial unloading and reloading: the slope of "
        "unloading against that of loading gives sigma, the knee gives n"
    ),
)


def _hardening_rate(at: Local) -> ca.SX:
    """``s z' = v - |v| z - δ v |z|``."""
    return (at.velocity - ca.fabs(at.velocity) * at.z.z - at.p.delta * at.velocity * ca.fabs(at.z.z)) / at.p.s


HARDENING_HYSTERESIS = Effect(
    id="hardening_hysteresis",
    kind="effort",
    title="Bouc-Wen hysteresis that stiffens",
    equation="F = f_c z,  s z' = v - |v| z - δ v |z|;  1 + δ < 0: stiffer the farther it goes; δ = 0: Dahl's",
    law=lambda at: at.p.f_c * at.z.z,
    dynamics=lambda at: {"z": _hardening_rate(at)},
    parameters=(
        replace(LEVEL, meaning="k s: the effort at the travel s, were the stiffness k constant"),
        replace(
            LENGTH, guess=0.1, lower=1e-3, upper=100.0, starts=(1.0,),
            meaning="travel s over which the slope of the loop changes by its own size",
        ),
        EffectParameter(
            "delta", ONE, "δ: at -1 a loading flank is straight, below it stiffens", guess=-1.0, lower=-5.0,
            upper=0.0, starts=(-1.5,),
        ),
    ),
    states=(EffectState("z", ONE, "hysteretic deflection over s"),),
    source=(
        "Noël, Schoukens (2016), Hysteretic benchmark with a dynamic nonlinearity (n = 1, γ > 0, γ + δ < 0); "
        "Ikhouane, Rodellar (2007), Systems with Hysteresis, Wiley, ch. 2 (classes of the model)"
    ),
    pattern=(
        "a hysteresis loop whose flanks grow steeper with the amplitude instead of yielding: wire rope, "
        "stacked leaves, a rubber stop"
    ),
    look_alikes=("bouc_wen", "cubic_stiffness", "dahl", "maxwell"),
    separating_experiment=(
        "quasi-static loops of growing amplitude: the slope at the tips grows with the amplitude and the "
        "loop encloses an area; a cubic spring encloses none, a friction's tips are flat"
    ),
)  # fmt: skip
