"""Laws that the league plants beside those of ``hybridid.rigs``: a play, a hysteresis, and some that no
library of ours knows.

As there: plain arithmetic in SI units that numba compiles, each resisting the motion of its contact. Every
law outside the library has its twin as an ``Effect`` here, for the oracle alone: the players never see it.
"""

from __future__ import annotations

import math

import casadi as ca

from hybridid.effects.dimension import DAMPING, EFFORT, POSITION, STIFFNESS, TIME, VELOCITY, Dimension
from hybridid.effects.effect import Effect, EffectParameter, EffectState
from hybridid.effects.smooth import saturated
from hybridid.rigs.laws import Law

# Signature of every law: t [s], q [m], v [m/s], direction s, states z, parameters p, rates dz.


def _backlash(t, q, v, s, z, p, dz):
    # z = displacement of the load against the contact, and its own absolute velocity
    omega = 2.0 * math.pi * p[1]
    gap = abs(z[0]) - p[3]
    pull = 0.0
    if gap > 0.0:
        pull = p[0] * (omega * omega * math.copysign(gap, z[0]) + 2.0 * p[2] * omega * (z[1] - v))
    dz[0] = z[1] - v
    dz[1] = -pull / p[0]
    return -pull


def _bouc_wen(t, q, v, s, z, p, dz):
    # z = F / f_c, n = 2
    dz[0] = (v - p[2] * s * v * abs(z[0]) * z[0] + (p[2] - 1.0) * v * z[0] * z[0]) / p[1]
    return p[0] * z[0]


def _end_stop(t, q, v, s, z, p, dz):
    return p[0] * max(q - p[1], 0.0)


def _eddy_brake(t, q, v, s, z, p, dz):
    return 2.0 * p[0] * (v / p[1]) / (1.0 + (v / p[1]) ** 2)


def _heating(t, q, v, s, z, p, dz):
    # z = travel of late, forgotten within tau: a measure of the contact's warmth
    dz[0] = s * v - z[0] / p[1]
    return -p[0] * z[0] * s


def _dent(t, q, v, s, z, p, dz):
    return p[0] * math.exp(-(((q - p[1]) / p[2]) ** 2))


def _position_damping(t, q, v, s, z, p, dz):
    return p[0] * q * v


def _step_disturbance(t, q, v, s, z, p, dz):
    return p[0] * 0.5 * (1.0 + math.tanh((t - p[1]) / 0.02))


def _blow_off(t, q, v, s, z, p, dz):
    return -p[0] * math.copysign(max(abs(v) - p[1], 0.0), v)


BACKLASH = Law(
    "backlash",
    "load behind a play: F = -m (w^2 dz(r) + 2 damping w r') while |r| > gap",
    _backlash,
    (("mass", "kg"), ("frequency", "Hz"), ("damping", ""), ("gap", "m")),
    states=2,
    sided=False,
    positive=("mass", "frequency"),
    source="Nordin, Gutman (2002), Automatica 38(10)",
)
BOUC_WEN = Law(
    "bouc_wen",
    "F = f_c z, s z' = v - sigma |v| |z| z + (sigma - 1) v z^2",
    _bouc_wen,
    (("f_c", "N"), ("s", "m"), ("sigma", "")),
    states=1,
    positive=("s",),
    source="Wen (1976), ASCE J. Engineering Mechanics Division 102(2)",
)
END_STOP = Law("end_stop", "F = k max(q - d, 0)", _end_stop, (("k", "N/m"), ("d", "m")), sided=False)
EDDY_BRAKE = Law(
    "eddy_brake",
    "F = 2 peak (v/v_c) / (1 + (v/v_c)^2): strongest at v_c",
    _eddy_brake,
    (("peak", "N"), ("v_c", "m/s")),
    sided=False,
    positive=("v_c",),
    source="Wouterse (1991), IEE Proc. B 138(4)",
)
HEATING = Law(
    "heating",
    "F = -c x sign(v), x' = |v| - x / tau: a contact that warms slides more easily",
    _heating,
    (("c", "N/m"), ("tau", "s")),
    states=1,
    dry=True,
    positive=("tau",),
)
DENT = Law(
    "dent",
    "F = amplitude exp(-((q - q_0) / width)^2): one bad place of the guide",
    _dent,
    (("amplitude", "N"), ("q_0", "m"), ("width", "m")),
    sided=False,
    positive=("width",),
)
POSITION_DAMPING = Law("position_damping", "F = c q v", _position_damping, (("c", "N s/m^2"),), sided=False)
STEP_DISTURBANCE = Law(
    "step_disturbance",
    "F = amplitude from the instant on, risen within some 20 ms",
    _step_disturbance,
    (("amplitude", "N"), ("instant", "s")),
    sided=False,
)
BLOW_OFF = Law(
    "blow_off",
    "F = -c (|v| - v_b) sign(v) above v_b: a damper's valve opens",
    _blow_off,
    (("c", "N s/m"), ("v_b", "m/s")),
    sided=False,
)
OWN_LAWS = {
    law.name: law
    for law in (
        BACKLASH, BOUC_WEN, END_STOP, EDDY_BRAKE, HEATING, DENT, POSITION_DAMPING, STEP_DISTURBANCE, BLOW_OFF
    )
}  # fmt: skip


def _twin(law: Law, write, parameters, states=(), dynamics=None) -> Effect:
    return Effect(
        id=law.name,
        kind="effort",
        title=law.name.replace("_", " "),
        equation=law.equation,
        law=write,
        parameters=parameters,
        states=states,
        dynamics=dynamics,
        source=law.source or "the league's own",
        pattern="not in the library",
    )


def _shape(name: str, dimension: Dimension, guess: float = 0.5) -> EffectParameter:
    return EffectParameter(name, dimension, name, guess=guess)


def _amplitude(name: str, dimension: Dimension) -> EffectParameter:
    return EffectParameter(name, dimension, name, guess=0.1, nests=True)


OUTSIDE = {
    effect.id: effect
    for effect in (
        _twin(
            EDDY_BRAKE,
            lambda at: 2 * at.p.peak * (at.velocity / at.p.v_c) / (1 + (at.velocity / at.p.v_c) ** 2),
            (_amplitude("peak", EFFORT), _shape("v_c", VELOCITY)),
        ),
        _twin(
            HEATING,
            lambda at: -at.p.c * at.z.x * at.sign,
            (_amplitude("c", STIFFNESS), EffectParameter("tau", TIME, "tau", guess=1.0, lower=0.05)),
            (EffectState("x", POSITION, "travel of late"),),
            lambda at: {"x": at.speed - at.z.x / at.p.tau},
        ),
        _twin(
            DENT,
            lambda at: at.p.amplitude * ca.exp(-(((at.position - at.p.q_0) / at.p.width) ** 2)),
            (_amplitude("amplitude", EFFORT), _shape("q_0", POSITION), _shape("width", POSITION)),
        ),
        _twin(
            POSITION_DAMPING,
            lambda at: at.p.c * at.position * at.velocity,
            (_amplitude("c", Dimension(effort=1, position=-2, time=1)),),
        ),
        _twin(
            STEP_DISTURBANCE,
            lambda at: at.p.amplitude * 0.5 * (1 + ca.tanh((at.time - at.p.instant) / 0.02)),
            (_amplitude("amplitude", EFFORT), EffectParameter("instant", TIME, "instant", absolute=True)),
        ),
        _twin(
            BLOW_OFF,
            lambda at: -at.p.c * (at.velocity - saturated(at.velocity, at.p.v_b, 1e-3)),
            (_amplitude("c", DAMPING), _shape("v_b", VELOCITY)),
        ),
    )
}
"""Twins of the laws outside the library, by name: what the oracle fits."""
