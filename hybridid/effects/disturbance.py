"""Periodic efforts: over position or over time."""

from __future__ import annotations

import math

import casadi as ca

from hybridid.effects.dimension import EFFORT, FREQUENCY, POSITION
from hybridid.effects.effect import Effect, EffectParameter, Local

AMPLITUDES = (
    EffectParameter("A_s", EFFORT, "amplitude of the sine", guess=0.02, nests=True),
    EffectParameter("A_c", EFFORT, "amplitude of the cosine", guess=0.02, nests=True),
)
PITCH = EffectParameter(
    "pitch",
    POSITION,
    "length of one period: pole pitch, screw lead, tooth",
    guess=0.3,
    lower=0.003,
    upper=10.0,
    starts=(0.03, 0.1, 1.0),
    sought="period",
)

COGGING = Effect(
    id="cogging",
    kind="effort",
    title="cogging",
    equation="F = A_s sin(2π q/pitch) + A_c cos(2π q/pitch)",
    law=lambda at: (
        at.p.A_s * ca.sin(2 * math.pi * at.position / at.p.pitch)
        + at.p.A_c * ca.cos(2 * math.pi * at.position / at.p.pitch)
    ),
    parameters=(
        *AMPLITUDES,
        PITCH,
    ),
    source=(
        "Otten, de Vries, van Amerongen, Rankers, Gaal (1997), Linear motor motion control using a "
        "learning feedforward controller, IEEE/ASME Trans. Mechatronics 2(3), 179-187"
    ),
    pattern=(
        "periodic in position, whatever the speed, and the same in both directions; position-dependent "
        "friction flips, a periodic disturbance keeps time"
    ),
    look_alikes=(
        "periodic_disturbance",
        "position_friction",
        "gravity",
        "linear_stiffness",
        "cyclic_inertia",
        "detent",
        "sensor_periodic_error",
    ),
    separating_experiment=(
        "constant-velocity runs at two speeds in both directions over many pitches: the ripple stays "
        "where it is in position and its frequency doubles with the speed"
    ),
)

OVER_TIME = "F = A_s sin(2π frequency t) + A_c cos(2π frequency t)"


def sine_over_time(at: Local) -> ca.SX:
    """The law of ``OVER_TIME``."""
    angle = 2 * math.pi * at.p.frequency * at.time
    return at.p.A_s * ca.sin(angle) + at.p.A_c * ca.cos(angle)


PERIODIC_DISTURBANCE = Effect(
    id="periodic_disturbance",
    kind="effort",
    title="periodic disturbance",
    equation=OVER_TIME,
    law=sine_over_time,
    parameters=(
        *AMPLITUDES,
        EffectParameter(
            "frequency",
            FREQUENCY,
            "frequency of the disturbance",
            guess=5.0,
            lower=0.01,
            upper=1000.0,
            starts=(1.0, 20.0, 50.0),
            absolute=True,
            sought="frequency",
        ),
    ),
    source=(
        "Bodson, Douglas (1997), Adaptive algorithms for the rejection of sinusoidal disturbances with "
        "unknown frequency, Automatica 33(12), 2213-2221"
    ),
    pattern=(
        "one line in the spectrum that is there at rest too and does not care where or how fast the "
        "machine moves"
    ),
    look_alikes=("cogging", "flexible_mode", "sensor_periodic_error"),
    separating_experiment=(
        "record at rest and at two speeds, ten seconds each: the line keeps its frequency and its phase "
        "from start to end"
    ),
)
