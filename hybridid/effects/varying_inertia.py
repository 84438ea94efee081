"""Inertia that depends on position: arms that extend, cables that pay out, cranks and linkages.

The kinetic energy ½ m(q) v² gives by Lagrange's equation the effort m(q) a + ½ m'(q) v², with m'(q) = dm/dq.
The constant part of the inertia is the plant's own, so no effect has it. A fit may not make the sum of both
zero or negative: there the simulation leaves the numbers, and the step is refused.
"""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import INERTIA, ONE, POSITION, Dimension
from hybridid.effects.effect import Effect, EffectParameter, Local

INERTIA_SLOPE = Dimension(effort=1, position=-2, time=2)
INERTIA_CURVATURE = Dimension(effort=1, position=-3, time=2)

_EKSERGIAN = (
    "Cardona Foix, Jordi Nebot, Puig-Ortiz (2017), Reduced inertial parameters in system of one degree of "
    "freedom obtained by Eksergian's method, Mechanical Sciences 8, 91"
)


def _effort(at: Local, inertia: ca.SX, slope: ca.SX) -> ca.SX:
    return inertia * at.acceleration + 0.5 * slope * at.velocity**2


def _polynomial(at: Local) -> ca.SX:
    x = at.position - at.p.q_0
    return _effort(at, (at.p.m_1 + at.p.m_2 * x) * x, at.p.m_1 + 2 * at.p.m_2 * x)


VARYING_INERTIA = Effect(
    id="varying_inertia",
    kind="effort",
    title="inertia that varies with position",
    equation="F = m a + ½ m' v²,  m = m_1 x + m_2 x²,  m' = m_1 + 2 m_2 x,  x = q - q_0",
    law=_polynomial,
    parameters=(
        EffectParameter("m_1", INERTIA_SLOPE, "change of the inertia with position", guess=0.05, nests=True),
        EffectParameter(
            "m_2",
            INERTIA_CURVATURE,
            "change of the inertia with the position squared",
            guess=0.05,
            nests=True,
        ),
        EffectParameter(
            "q_0",
            POSITION,
            "place where the inertia is the plant's alone, fixed: best in mid-stroke",
            guess=0.0,
            fixed=True,
        ),
    ),
    source=f"{_EKSERGIAN}; its inertia to second order in the position",
    pattern=(
        "the machine is heavier at one place of the stroke than at another: its share of the effort follows "
        "the acceleration times the position, and at constant speed the square of the speed"
    ),
    look_alikes=(
        "added_inertia",
        "cyclic_inertia",
        "position_damping",
        "asymmetric_viscous",
        "sensor_nonlinearity",
    ),
    separating_experiment=(
        "the same short acceleration to and fro at five places of the stroke: effort over acceleration is a "
        "curve over position. Friction and springs stay when the acceleration is halved"
    ),
    position_units=("m", "mm"),
)


def _harmonic(at: Local) -> ca.SX:
    n, angle = at.p.n, at.p.n * at.position
    sine, cosine = ca.sin(angle), ca.cos(angle)
    return _effort(at, at.p.m_c * cosine + at.p.m_s * sine, n * (at.p.m_s * cosine - at.p.m_c * sine))


# sin and cos need an angle: only at ports in rad
CYCLIC_INERTIA = Effect(
    id="cyclic_inertia",
    kind="effort",
    title="inertia that varies over a turn",
    equation=("F = m a + ½ m' v²,  m = m_c cos(n q) + m_s sin(n q),  m' = n (m_s cos(n q) - m_c sin(n q))"),
    law=_harmonic,
    parameters=(
        EffectParameter("m_c", INERTIA, "amplitude of the cosine", guess=0.05, nests=True),
        EffectParameter("m_s", INERTIA, "amplitude of the sine", guess=0.05, nests=True),
        EffectParameter(
            "n",
            ONE,
            "periods in a turn, fixed: 1 for two links, 2 for a crank",
            guess=1.0,
            lower=1.0,
            starts=(2.0,),
            fixed=True,
        ),
    ),
    source=f"{_EKSERGIAN}; one harmonic of its inertia",
    pattern=(
        "the machine is heavier at one angle than at another, and its speed ripples at constant torque by the"
        " same share at every speed; gravity ripples less the faster it turns"
    ),
    look_alikes=("added_inertia", "gravity", "cogging", "varying_inertia", "sensor_nonlinearity"),
    separating_experiment=(
        "turns at two constant speeds: the ripple of the torque grows with the square of the speed, where "
        "that of gravity and cogging stays"
    ),
    position_units=("rad",),
)
