"""Laws of joints, dampers and tyres: relaxation, bristle friction, asymmetric damping, lift-off.

As in ``law_library``: plain arithmetic in SI units. A law resists the motion of its contact. With the first
parameter at zero, it gives zero.
"""

# mypy: disallow-untyped-defs=False, disallow-incomplete-defs=False
# (every law has the signature of ``laws``, which numba compiles it for)

from __future__ import annotations

import math

from hybridid.rigs.laws import Law

# Signature of every function below: t [s], q [m], v [m/s], direction s, states z, parameters p, rates dz.


def _maxwell(t, q, v, s, z, p, dz):
    # z = deflection of the branch's spring
    dz[0] = v - z[0] / p[1]
    return p[0] * z[0]


def _lugre(t, q, v, s, z, p, dz):
    # z = deflection of the bristles [m]; g(v) is the friction of steady sliding at v
    f_c, f_s, v_s, sigma_0, sigma_1 = p[0], p[1], p[2], p[3], p[4]
    g = f_c + (f_s - f_c) * math.exp(-((v / v_s) ** 2))
    dz[0] = v - sigma_0 * s * v * z[0] / g
    return sigma_0 * z[0] + sigma_1 * dz[0]


def _asymmetric_damper(t, q, v, s, z, p, dz):
    return -0.5 * p[0] * (math.sqrt(v * v + p[1] * p[1]) - p[1])


def _wheel_lift_off(t, q, v, s, z, p, dz):
    return p[0] * max(-q - p[1], 0.0)


MAXWELL = Law(
    "maxwell",
    "F = k x, x' = v - x / tau",
    _maxwell,
    (("k", "N/m"), ("tau", "s")),
    states=1,
    sided=False,
    positive=("tau",),
    source="Findley, Lai, Onaran (1976), Creep and relaxation of nonlinear viscoelastic materials, ch. 5",
)
LUGRE = Law(
    "lugre",
    "F = sigma_0 z + sigma_1 z', z' = v - sigma_0 |v| z / g(v), g = f_c + (f_s - f_c) exp(-(v / v_s)^2)",
    _lugre,
    (("f_c", "N"), ("f_s", "N"), ("v_s", "m/s"), ("sigma_0", "N/m"), ("sigma_1", "N s/m")),
    states=1,
    positive=("f_c", "f_s", "v_s", "sigma_0"),
    source="Canudas de Wit, Olsson, Astrom, Lischinsky (1995), IEEE Trans. Automatic Control 40(3)",
)
ASYMMETRIC_DAMPER = Law(
    "asymmetric_damper",
    "F = -(difference / 2) (sqrt(v^2 + knee^2) - knee), difference = c(v<0) - c(v>0) well above the knee",
    _asymmetric_damper,
    (("difference", "N s/m"), ("knee", "m/s")),
    sided=False,
    positive=("knee",),
    source="Dixon (2007), The shock absorber handbook, 2nd ed., ch. 5 to 7",
)
WHEEL_LIFT_OFF = Law(
    "wheel_lift_off",
    "F = k max(-q - d, 0): a tyre k q about its static load k d cannot pull",
    _wheel_lift_off,
    (("k", "N/m"), ("d", "m")),
    sided=False,
    positive=("d",),
    source="Pfeiffer, Glocker (1996), Multibody dynamics with unilateral contacts, ch. 5",
)
