"""Laws of real machines that the drawn league hides and no library of ours had when it was drawn.

As in ``hybridid.rigs``: plain arithmetic in SI units that numba compiles, each resisting the motion of its
contact. ``load`` is the drive's effort, which the rig tells the law (see ``told``).
"""

from __future__ import annotations

import math

from hybridid.rigs.laws import Law

# Signature of every law: t [s], q [m], v [m/s], direction s, states z, parameters p, rates dz.


def _load_friction(t, q, v, s, z, p, dz):
    return p[0] * abs(p[1]) * s


def _two_sided_load_friction(t, q, v, s, z, p, dz):
    level = p[0] if p[1] * s > 0.0 else p[0] * p[2]
    return level * abs(p[1]) * s


def _following_friction(t, q, v, s, z, p, dz):
    # z = the level, a late copy of |load|
    dz[0] = (abs(p[1]) - z[0]) / p[2]
    return p[0] * z[0] * s


def _varying_inertia(t, q, v, s, z, p, dz):
    x = (q - p[2]) / p[3]
    m = p[0] * math.exp(-x * x)
    slope = -2.0 * x / p[3] * m
    others = p[5] * v + p[6] * s + p[7] + p[8] * q
    return (m * (p[1] - others) + 0.5 * p[4] * slope * v * v) / (p[4] + m)


def _friction_behind_gap(t, q, v, s, z, p, dz):
    # z = position of the block that slides; it is dragged as its spring comes to carry f_c
    apart = q - z[0]
    bent = min(max((abs(apart) - p[1]) / p[2], 0.0), 1.0)
    dz[0] = v * bent**8 if v * apart > 0.0 else 0.0
    return p[0] * math.copysign(bent, apart)


def _hardening_hysteresis(t, q, v, s, z, p, dz):
    dz[0] = (v - p[2] * s * v * z[0] - p[3] * v * abs(z[0])) / p[1]
    return p[0] * z[0]


LOAD_FRICTION = Law(
    "load_friction",
    "F = mu |load| sign(v)",
    _load_friction,
    (("mu", ""), ("load", "N")),
    dry=True,
    source="Armstrong-Helouvry, Dupont, Canudas de Wit (1994), Automatica 30(7)",
)
TWO_SIDED_LOAD_FRICTION = Law(
    "two_sided_load_friction",
    "F = mu |load| sign(v) where the drive drives, ratio mu |load| sign(v) where it brakes",
    _two_sided_load_friction,
    (("mu", ""), ("load", "N"), ("ratio", "")),
    dry=True,
    source="Kermani, Patel, Moallem (2007); Budynas, Nisbett (2015), Shigley's, ch. 8 (power screws)",
)
FOLLOWING_FRICTION = Law(
    "following_friction",
    "F = mu x sign(v), tau x' = |load| - x: a brake or a damper whose field is set by the input",
    _following_friction,
    (("mu", ""), ("load", "N"), ("tau", "s")),
    states=1,
    dry=True,
    positive=("tau",),
    source="Spencer, Dyke, Sain, Carlson (1997), ASCE J. Engineering Mechanics 123(3)",
)
VARYING_INERTIA = Law(
    "varying_inertia",
    "(M + m(q)) q'' + m'(q) q'^2 / 2 = load - others, m = dm exp(-((q - q_0) / width)^2)",
    _varying_inertia,
    (
        ("dm", "kg"), ("load", "N"), ("q_0", "m"), ("width", "m"), ("M", "kg"), ("f_v", "N s/m"),
        ("f_c", "N"), ("offset", "N"), ("k", "N/m"),
    ),
    positive=("width", "M"),
    source="Lagrange's equation of one coordinate; Khalil, Dombre (2004), ch. 9",
)  # fmt: skip
FRICTION_BEHIND_GAP = Law(
    "friction_behind_gap",
    "a block of friction f_c behind a gap and a spring that bends by s: nothing acts inside the gap",
    _friction_behind_gap,
    (("f_c", "N"), ("gap", "m"), ("s", "m")),
    states=1,
    sided=False,
    positive=("s",),
    source="Badrakhan (1985), J. Sound and Vibration 100(2)",
)
HARDENING_HYSTERESIS = Law(
    "hardening_hysteresis",
    "F = f_c z, s z' = v - gamma |v| z - delta v |z| with gamma + delta < 0: a loop that stiffens",
    _hardening_hysteresis,
    (("f_c", "N"), ("s", "m"), ("gamma", ""), ("delta", "")),
    states=1,
    positive=("s",),
    source="Noel, Schoukens (2016), Hysteretic benchmark with a dynamic nonlinearity",
)
NAMED = {
    law.name: law
    for law in (
        LOAD_FRICTION, TWO_SIDED_LOAD_FRICTION, FOLLOWING_FRICTION, VARYING_INERTIA, FRICTION_BEHIND_GAP,
        HARDENING_HYSTERESIS,
    )
}  # fmt: skip
