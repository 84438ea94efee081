"""Hysteresis of Bouc and Wen: a loop that depends on travel and not on speed, and yields or stiffens.

The laws use the exact ``|v|``, as those of ``presliding`` do.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from hybridid.effects.dimension import ONE
from hybridid.effects.effect import Effect, EffectParameter, EffectState, Local
from hybridid.effects.presliding import LENGTH, LEVEL

TINY = 1e-12
"""Keeps the derivative of ``|z|^n`` finite at z = 0 for every n."""


def _bouc_wen_rate(at: Local) -> ca.SX:
    v, z, n, sigma = at.velocity, at.z.z, at.p.n, at.p.sigma
    size = ca.sqrt(z**2 + TINY)
    sharp = size ** (n - 1)
    slip = sigma * ca.fabs(v) * sharp * z - (sigma - 1) * v * sharp * size
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
