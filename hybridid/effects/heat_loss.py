"""Heat that a body loses to its surroundings: q is its temperature above theirs, F the flow of heat."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from hybridid.effects.dimension import POSITION, STIFFNESS
from hybridid.effects.effect import Effect, EffectParameter, Local

TEMPERATURES = ("[°K]*",)
"""Units of a level that is a temperature."""
KELVIN = replace(POSITION, called="K")
"""An absolute temperature: the scale of the level, whatever the zero of its unit is."""
ALIKE = ("linear_leak", "side_capacity", "sensor_nonlinearity")


def _conductance(meaning: str) -> EffectParameter:
    """The amplitude of a loss: a further conductance."""
    return EffectParameter("k", STIFFNESS, meaning, guess=0.1, lower=0.0, nests=True)


def _convected(at: Local) -> ca.SX:
    size = (at.position**2 + at.p.width**2) / at.p.q_r**2
    return at.p.k * at.position * size**0.125


NATURAL_CONVECTION = Effect(
    id="natural_convection",
    kind="flow",
    position_units=TEMPERATURES,
    title="natural convection",
    equation="F = k q (|q|/q_r)^(1/4),  |q| ≈ √(q² + w²)",
    law=_convected,
    parameters=(
        _conductance("conductance where the body is q_r warmer"),
        EffectParameter(
            "q_r",
            POSITION,
            "reference q_r, fixed: it only sets what k means",
            guess=1.0,
            fixed=True,
        ),
        EffectParameter("width", POSITION, "rounding w at no difference", guess=1e-3, lower=0.0, fixed=True),
    ),
    source=(
        "laminar flow along a surface: Incropera, DeWitt, Bergman, Lavine (2007), Fundamentals of Heat and "
        "Mass Transfer, 6th ed., sec. 9.6 (Nusselt number as the Rayleigh number to the power 1/4)"
    ),
    pattern=(
        "a loss that grows faster than the temperature above the surroundings: by a fifth more where that "
        "doubles"
    ),
    look_alikes=("thermal_radiation", *ALIKE),
    separating_experiment=(
        "hold the body at three temperatures far apart, each until the power is steady: the power over the "
        "difference to the surroundings grows with its fourth root; a fan takes the bend away, but none that "
        "radiation makes"
    ),
)

THERMAL_RADIATION = Effect(
    id="thermal_radiation",
    kind="flow",
    position_units=TEMPERATURES,
    title="thermal radiation",
    equation="F = k T_s ((1 + q/T_s)⁴ - 1)/4",
    law=lambda at: at.p.k * at.p.T_s / 4 * ((1 + at.position / at.p.T_s) ** 4 - 1),
    parameters=(
        _conductance("conductance where the body is as warm as the surroundings: 4 ε σ A T_s³"),
        EffectParameter(
            "T_s",
            KELVIN,
            "absolute temperature of the surroundings, fixed: 293 K",
            guess=293.0,
            absolute=True,
            fixed=True,
        ),
    ),
    source=(
        "Stefan-Boltzmann law: Incropera, DeWitt, Bergman, Lavine (2007), Fundamentals of Heat and Mass "
        "Transfer, 6th ed., sec. 1.2.3"
    ),
    pattern=(
        "a loss that grows faster than the temperature above the surroundings: with the fourth power of the "
        "absolute one"
    ),
    look_alikes=("natural_convection", *ALIKE),
    separating_experiment=(
        "repeat a run with the body blackened or polished: radiation changes with its emissivity, convection "
        "does not"
    ),
)
