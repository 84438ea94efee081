"""The laws of which a rig's truth consists, and the effects that can be planted in it.

Plain arithmetic in SI units, each resisting the motion of its contact (see ``laws``). The first
parameter of each is its amplitude: at zero the law gives zero.
"""

# mypy: disallow-untyped-defs=False, disallow-incomplete-defs=False
# (every law has the signature of ``laws``, which numba compiles it for)

from __future__ import annotations

import math

from hybridid.rigs.contact_laws import ASYMMETRIC_DAMPER, LUGRE, MAXWELL, WHEEL_LIFT_OFF
from hybridid.rigs.laws import Law, Planted, RigError, nearest
from hybridid.rigs.load_laws import LOAD_FRICTION, LOAD_STRIBECK, TWO_SIDED_LOAD_FRICTION, WEIGHT

# Signature of every function below: t [s], q [m], v [m/s], direction s, states z, parameters p, rates dz.


def _viscous(t, q, v, s, z, p, dz):
    return p[0] * v


def _coulomb(t, q, v, s, z, p, dz):
    return p[0] * s


def _offset(t, q, v, s, z, p, dz):
    return p[0]


def _stiffness(t, q, v, s, z, p, dz):
    return p[0] * (q - p[1])


def _asymmetric_viscous(t, q, v, s, z, p, dz):
    return -0.5 * p[0] * s * v


def _asymmetric_coulomb(t, q, v, s, z, p, dz):
    return -0.5 * p[0] * s * s


def _stribeck(t, q, v, s, z, p, dz):
    return p[0] * s * math.exp(-((v / p[1]) ** 2))


def _quadratic_drag(t, q, v, s, z, p, dz):
    return p[0] * s * v * v


def _cubic_stiffness(t, q, v, s, z, p, dz):
    return p[0] * (q - p[1]) ** 3


def _cogging(t, q, v, s, z, p, dz):
    return p[0] * math.sin(2.0 * math.pi * q / p[1] + p[2])


def _position_friction(t, q, v, s, z, p, dz):
    return p[0] * (q - p[1]) * s


def _friction_drift(t, q, v, s, z, p, dz):
    return p[0] * t * s


def _dahl(t, q, v, s, z, p, dz):
    # z = F / F_d. With s for sign(v) the bristle is smooth within one direction.
    dz[0] = p[1] / p[0] * v * (1.0 - s * z[0])
    return p[0] * z[0]


def _flexible_mode(t, q, v, s, z, p, dz):
    # z = deflection of the appended mass against the contact, and its own absolute velocity.
    omega = 2.0 * math.pi * p[1]
    pull = p[0] * (omega * omega * z[0] + 2.0 * p[2] * omega * (z[1] - v))
    dz[0] = z[1] - v
    dz[1] = -pull / p[0]
    return -pull


VISCOUS = Law("viscous", "F = f_v v", _viscous, (("f_v", "N s/m"),), sided=False)
COULOMB = Law("coulomb", "F = f_c sign(v)", _coulomb, (("f_c", "N"),), dry=True)
OFFSET = Law("offset", "F = offset", _offset, (("offset", "N"),), sided=False)
STIFFNESS = Law(
    "stiffness", "F = k (q - q_0)", _stiffness, (("k", "N/m"), ("q_0", "m")), sided=False, carried=True
)
ASYMMETRIC_VISCOUS = Law(
    "asymmetric_viscous",
    "F = -(difference / 2) |v|, difference = f_v(v<0) - f_v(v>0)",
    _asymmetric_viscous,
    (("difference", "N s/m"),),
    source="Janot, Gautier, Brunot (2019), Eq. (12)",
)
ASYMMETRIC_COULOMB = Law(
    "asymmetric_coulomb",
    "F = -(difference / 2) |sign(v)|, difference = f_c(v<0) - f_c(v>0)",
    _asymmetric_coulomb,
    (("difference", "N"),),
    dry=True,
    source="Janot, Gautier, Brunot (2019), Eq. (12)",
)
STRIBECK = Law(
    "stribeck",
    "F = amplitude sign(v) exp(-(v / velocity)^2)",
    _stribeck,
    (("amplitude", "N"), ("velocity", "m/s")),
    dry=True,
    positive=("velocity",),
    source="Armstrong-Helouvry, Dupont, Canudas de Wit (1994), Automatica 30(7)",
)
QUADRATIC_DRAG = Law("quadratic_drag", "F = c v |v|", _quadratic_drag, (("c", "N s^2/m^2"),))
CUBIC_STIFFNESS = Law(
    "cubic_stiffness",
    "F = k_3 (q - q_0)^3",
    _cubic_stiffness,
    (("k_3", "N/m^3"), ("q_0", "m")),
    sided=False,
)
COGGING = Law(
    "cogging",
    "F = amplitude sin(2 pi q / pitch + phase)",
    _cogging,
    (("amplitude", "N"), ("pitch", "m"), ("phase", "rad")),
    sided=False,
    positive=("pitch",),
)
POSITION_FRICTION = Law(
    "position_friction",
    "F = slope (q - q_0) sign(v)",
    _position_friction,
    (("slope", "N/m"), ("q_0", "m")),
    dry=True,
)
FRICTION_DRIFT = Law("friction_drift", "F = rate t sign(v)", _friction_drift, (("rate", "N/s"),), dry=True)
DAHL = Law(
    "dahl",
    "F = amplitude z, z' = (stiffness / amplitude) (v - |v| z)",
    _dahl,
    (("amplitude", "N"), ("stiffness", "N/m")),
    states=1,
    positive=("amplitude", "stiffness"),
    source="Dahl (1968), Aerospace Corporation TOR-0158(3107-18)-1",
)
FLEXIBLE_MODE = Law(
    "flexible_mode",
    "mass appended by a spring: x'' = -w^2 (x - q) - 2 damping w (x' - v), F = mass x'', w = 2 pi frequency",
    _flexible_mode,
    (("mass", "kg"), ("frequency", "Hz"), ("damping", "")),
    states=2,
    sided=False,
    positive=("mass", "frequency"),
)

LAWS: tuple[Law, ...] = (
    VISCOUS,
    COULOMB,
    OFFSET,
    STIFFNESS,
    ASYMMETRIC_VISCOUS,
    ASYMMETRIC_COULOMB,
    STRIBECK,
    QUADRATIC_DRAG,
    CUBIC_STIFFNESS,
    COGGING,
    POSITION_FRICTION,
    FRICTION_DRIFT,
    DAHL,
    FLEXIBLE_MODE,
    MAXWELL,
    LUGRE,
    ASYMMETRIC_DAMPER,
    WHEEL_LIFT_OFF,
    LOAD_FRICTION,
    LOAD_STRIBECK,
    TWO_SIDED_LOAD_FRICTION,
    WEIGHT,
)


def law_named(name: str) -> Law:
    """The law called ``name``.

    Raises:
        RigError: if there is none, with the nearest name.
    """
    for law in LAWS:
        if law.name == name:
            return law
    raise RigError(f"no law {name!r} to plant{nearest(name, [law.name for law in LAWS])}")


def plant(name: str, **values: float) -> Planted:
    """``plant("stribeck", amplitude=5.0, velocity=0.01)``: a law of the library, by name, with its values."""
    return law_named(name)(**values)
