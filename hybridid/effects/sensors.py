"""Errors of a sensor that depend on what it shows: a bent characteristic, and one that repeats."""

from __future__ import annotations

import math

import casadi as ca

from hybridid.effects.dimension import EFFORT, Dimension
from hybridid.effects.effect import Effect, EffectParameter, Local

QUADRATIC = Dimension(effort=-1)
CUBIC = Dimension(effort=-2)
MOST = 0.3
"""Of the signal's scale, that either term may err by there: no sensor that is in use is bent by more."""

SENSOR_NONLINEARITY = Effect(
    id="sensor_nonlinearity",
    kind="output",
    title="sensor whose characteristic is bent",
    equation="y → y + c_2 y² + c_3 y³",
    law=lambda at: (at.p.c_2 + at.p.c_3 * at.signal) * at.signal**2,
    parameters=(
        EffectParameter("c_2", QUADRATIC, "quadratic error of the sensor", 0.01, -MOST, MOST, nests=True),
        EffectParameter("c_3", CUBIC, "cubic error of the sensor", 0.01, -MOST, MOST, nests=True),
    ),
    source=(
        "Fraden (2016), Handbook of Modern Sensors, 5th ed., ch. 3 (nonlinearity error); Rivera, Herrera, "
        "Chacón, Acosta, Carrillo (2008), Sensors 8(11), 7410-7427 (polynomial calibration)"
    ),
    pattern=(
        "an error of the output that is a curve over the output itself, the same at every speed and at rest; "
        "a spring that hardens moves the machine too. A mass behind a bent sensor seems to vary with position"
    ),
    look_alikes=(
        "sensor_scale",
        "sensor_offset",
        "sensor_periodic_error",
        "cubic_stiffness",
        "varying_inertia",
        "cyclic_inertia",
    ),
    separating_experiment=(
        "compare the output with a gauge at ten positions over the whole range: the difference is a curve, "
        "alike on the way out and back"
    ),
)


def _ripple(at: Local) -> ca.SX:
    angle = 2 * math.pi * at.signal / at.p.period
    return at.p.A_s * ca.sin(angle) + at.p.A_c * ca.cos(angle)


SENSOR_PERIODIC_ERROR = Effect(
    id="sensor_periodic_error",
    kind="output",
    title="periodic error of the sensor",
    equation="y → y + A_s sin(2π y/period) + A_c cos(2π y/period)",
    law=_ripple,
    parameters=(
        EffectParameter("A_s", EFFORT, "amplitude of the sine", guess=0.003, nests=True),
        EffectParameter("A_c", EFFORT, "amplitude of the cosine", guess=0.003, nests=True),
        EffectParameter(
            "period",
            EFFORT,
            "length of one period: a turn of an eccentric disc, a line of a scale",
            guess=0.3,
            lower=1e-4,
            upper=100.0,
            sought="period",
        ),
    ),
    source=(
        "Mendenhall, Windover, Henins, Cline (2015), An algorithm for compensation of short-period errors in "
        "optical encoders, Metrologia 52(5), 685; its cause in the quadrature signals: Heydemann (1981), "
        "Applied Optics"
    ),
    pattern=(
        "an error of the output that repeats over the output, whatever the speed and at rest; cogging moves "
        "the machine, so that it fades as the machine gets faster"
    ),
    look_alikes=("cogging", "sensor_nonlinearity", "periodic_disturbance", "periodic_flow"),
    separating_experiment=(
        "constant-velocity runs at two speeds over many periods: the ripple of the output keeps its size in "
        "position, where that of cogging falls with the square of the speed"
    ),
)
