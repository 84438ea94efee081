"""Laws that see what their contact carries, and the weight that loads it.

As in ``law_library``: plain arithmetic in SI units, zero where the first parameter is zero. After its own
parameters, a loaded law finds the contact's drive, p[-2], and load, p[-1] (see ``laws``).
"""

# mypy: disallow-untyped-defs=False, disallow-incomplete-defs=False
# (every law has the signature of ``laws``, which numba compiles it for)

from __future__ import annotations

import math

from hybridid.rigs.laws import Law

# Signature of every function below: t [s], q [m], v [m/s], direction s, states z, parameters p, rates dz.


def _load_friction(t, q, v, s, z, p, dz):
    return p[0] * abs(p[-2] - p[-1]) * s


def _load_stribeck(t, q, v, s, z, p, dz):
    return p[0] * abs(p[-2] - p[-1]) * s * math.exp(-((v / p[1]) ** 2))


def _two_sided(t, q, v, s, z, p, dz):
    return (p[0] * abs(p[-2]) + p[1] * abs(p[-1])) * s


def _weight(t, q, v, s, z, p, dz):
    return p[0] * math.sin(q - p[1])


LOAD_FRICTION = Law(
    "load_friction",
    "F = mu |drive - load| sign(v)",
    _load_friction,
    (("mu", ""),),
    dry=True,
    source="Coulomb's law on the force that a screw or gear transmits",
    loaded=True,
)
LOAD_STRIBECK = Law(
    "load_stribeck",
    "F = mu |drive - load| sign(v) exp(-(v / velocity)^2)",
    _load_stribeck,
    (("mu", ""), ("velocity", "m/s")),
    dry=True,
    positive=("velocity",),
    source="Duclusaud, Passault, Padois, Ly (2025), IEEE ICRA, model M4",
    loaded=True,
)
TWO_SIDED_LOAD_FRICTION = Law(
    "two_sided_load_friction",
    "F = (mu_drive |drive| + mu_load |load|) sign(v)",
    _two_sided,
    (("mu_drive", ""), ("mu_load", "")),
    dry=True,
    source="Duclusaud, Passault, Padois, Ly (2025), IEEE ICRA, model M5 for sides that oppose each other",
    loaded=True,
)
WEIGHT = Law(
    "weight",
    "F = amplitude sin(q - q_0): a weight on a lever",
    _weight,
    (("amplitude", "N"), ("q_0", "rad")),
    sided=False,
    carried=True,
)
