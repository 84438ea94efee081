"""Bodies that move with the port: rigidly, behind a spring, or behind a backlash.

A hidden body has the displacement r and the velocity w relative to the port. In these coordinates it
starts near zero at any position of the machine, and the port's acceleration a excites it.
"""

from __future__ import annotations

import math

import casadi as ca

from hybridid.effects.dimension import FREQUENCY, INERTIA, ONE, POSITION, VELOCITY
from hybridid.effects.effect import Effect, EffectParameter, EffectState, Local
from hybridid.effects.smooth import dead_zone, engagement

ADDED_INERTIA = Effect(
    id="added_inertia",
    kind="effort",
    title="added inertia",
    equation="F = m_a a",
    law=lambda at: at.p.m_a * at.acceleration,
    parameters=(
        EffectParameter("m_a", INERTIA, "inertia that moves along", guess=0.1, lower=0.0, nests=True),
    ),
    source="Newman (1977), Marine Hydrodynamics, sec. 4.14; Khalil, Dombre (2002), ch. 9",
    pattern=(
        "proportional to the acceleration; where the plant's own inertia at the port is free they are "
        "one, so it speaks only where that is known"
    ),
    look_alikes=("flexible_mode", "input_gain", "linear_stiffness", "varying_inertia", "cyclic_inertia"),
    separating_experiment=(
        "the same run with a known mass attached, and accelerations over a decade of frequency: a rigid "
        "inertia shows no resonance"
    ),
)

LOAD = EffectParameter(
    "m_l", INERTIA, "inertia of the load behind", guess=0.1, lower=0.0, nests=True, sought="load"
)
LOAD_STATES = (
    EffectState("r", POSITION, "displacement of the load relative to the port", scale=0.01),
    EffectState("w", VELOCITY, "velocity of the load relative to the port", scale=0.1),
)


def _spring_pull(at: Local) -> ca.SX:
    """Effort of the spring and damper on the load, divided by the load's inertia."""
    omega = 2 * math.pi * at.p.frequency
    return omega**2 * at.z.r + 2 * at.p.zeta * omega * at.z.w


FLEXIBLE_MODE = Effect(
    id="flexible_mode",
    kind="effort",
    title="load behind a spring",
    equation="F = -m_l (ω² r + 2 ζ ω w),  r' = w,  w' = -a - ω² r - 2 ζ ω w,  ω = 2π frequency",
    law=lambda at: -at.p.m_l * _spring_pull(at),
    dynamics=lambda at: {"r": at.z.w, "w": -at.acceleration - _spring_pull(at)},
    parameters=(
        LOAD,
        EffectParameter(
            "frequency",
            FREQUENCY,
            "natural frequency of the load with the port held",
            guess=3.0,
            lower=0.02,
            upper=200.0,
            starts=(0.3, 10.0, 30.0),
            sought="frequency",
        ),
        EffectParameter(
            "zeta",
            ONE,
            "damping ratio ζ",
            guess=0.05,
            lower=1e-3,
            upper=2.0,
            minor=True,
            lost_above=True,
        ),
    ),
    states=LOAD_STATES,
    source=(
        "Den Hartog (1956), Mechanical Vibrations, 4th ed., sec. 3.2 and 3.3; Spong (1987), ASME J. Dyn. "
        "Syst. Meas. Control 109(4), 310-319"
    ),
    pattern=(
        "ringing at one frequency after each change of acceleration, an antiresonance there from effort "
        "to motion; at slow motion an added inertia"
    ),
    look_alikes=("added_inertia", "backlash", "maxwell", "periodic_disturbance", "sensor_lag"),
    separating_experiment=(
        "a swept sine of effort through the expected frequency at two amplitudes: the antiresonance and "
        "resonance stay where they are, unlike with a play"
    ),
)


EDGE = EffectParameter(
    "width", POSITION, "rounding of the play's edges", guess=5e-7, lower=0.0, fixed=True, smooths=2
)
"""Narrow: a closed contact gives way by a/ω² at the acceleration a, at 100 Hz and 1 m/s² by 2.5 µm. An edge
as round as that would pass for a soft contact. A descent begins with a hundred times the width."""


def _contact_pull(at: Local) -> ca.SX:
    """Effort of the contact on the load, divided by the load's inertia; zero inside the play."""
    omega = 2 * math.pi * at.p.frequency
    touching = engagement(at.z.r, at.p.g, at.p.width)
    return omega**2 * dead_zone(at.z.r, at.p.g, at.p.width) + 2 * at.p.zeta * omega * touching * at.z.w


BACKLASH = Effect(
    id="backlash",
    kind="effort",
    title="load behind a play (backlash)",
    equation=(
        "F = -m_l (ω² dz(r) + 2 ζ ω dz'(r) w),  r' = w,  w' = -a + F/m_l,  ω = 2π frequency,  dz(r) = r -"
        " sat(r, g): 0 within ±g"
    ),
    law=lambda at: -at.p.m_l * _contact_pull(at),
    dynamics=lambda at: {"r": at.z.w, "w": -at.acceleration - _contact_pull(at)},
    parameters=(
        LOAD,
        EffectParameter(
            "g",
            POSITION,
            "half the play",
            guess=0.003,
            lower=1e-5,
            upper=1.0,
            starts=(3e-4, 0.03),
            sought="play",
        ),
        EffectParameter(
            "frequency",
            FREQUENCY,
            "natural frequency of the load on the closed contact",
            guess=20.0,
            lower=0.2,
            upper=200.0,
            minor=True,
            sought="frequency",
        ),
        EffectParameter(
            "zeta", ONE, "damping ratio ζ of the contact", guess=0.3, lower=0.01, upper=3.0, minor=True
        ),
        EDGE,
    ),
    states=LOAD_STATES,
    source=(
        "Nordin, Gutman (2002), Controlling mechanical systems with backlash: a survey, Automatica "
        "38(10), 1633-1649, dead-zone model of a two-mass drive"
    ),
    pattern=(
        "after each change of the sign of acceleration the machine is lighter for a short travel, then "
        "the load arrives with a knock; depends on travel and on which side the load lies. At a port that"
        " measures the deflection of a joint the play is free_play"
    ),
    look_alikes=("flexible_mode", "free_play", "dahl", "bouc_wen", "stribeck"),
    separating_experiment=(
        "small slow reversals, with the load's side measured too or held by a bias: the lost motion is "
        "the same at every effort, and vanishes when a constant bias keeps the contact on one side"
    ),
)
