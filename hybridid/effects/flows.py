"""Flows that leave a tank. At its port the position is the level, and an effort is a flow that lowers it.

A leak whose flow is proportional to the level is ``linear_stiffness``: F = k q.
"""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import EFFORT, POSITION, STIFFNESS
from hybridid.effects.effect import Effect, EffectParameter, Local
from hybridid.effects.smooth import ramp

FLOW_UNITS = ("*/s", "*/min", "*/h")
"""Units of an effort that is a flow: V/s, m/s, m³/s, L/min."""
HEIGHT = EffectParameter(
    "h", POSITION, "reference height, fixed: it only sets what the coefficient means", guess=1.0, fixed=True
)


def _over_the_edge(at: Local) -> ca.SX:
    over = ramp(at.position - at.p.limit, at.p.width)
    return at.p.k * over * ca.sqrt(over / at.p.h)


OVERFLOW = Effect(
    id="overflow",
    kind="effort",
    title="overflow over an edge",
    equation="F = k r √(r/h),  r = ramp(q - limit),  ramp(x) = 0 for x < 0, x for x > 0",
    law=_over_the_edge,
    parameters=(
        EffectParameter(
            "k", STIFFNESS, "flow over height, where the level is h above the edge", guess=1.0, lower=0.0,
            nests=True,
        ),
        EffectParameter(
            "limit", POSITION, "level of the edge", guess=0.8, lower=-5.0, upper=5.0, sought="place"
        ),
        HEIGHT,
        EffectParameter("width", POSITION, "rounding of the edge", guess=1e-3, lower=0.0, fixed=True),
    ),
    source=(
        "Francis (1855), Lowell Hydraulic Experiments (rectangular weir); White (2011), Fluid Mechanics, 7th "
        "ed., sec. 10.7"
    ),
    pattern=(
        "nothing up to one level, then a flow that rises faster than the level; the level stays near the edge"
        " whatever more flows in"
    ),
    look_alikes=("end_stop", "orifice_leak", "cubic_stiffness", "input_saturation"),
    separating_experiment=(
        "fill slowly past the suspected edge with several inflows: the level stands above the edge by the "
        "inflow to the power 2/3, above an elastic stop in proportion to it"
    ),
    effort_units=FLOW_UNITS,
)  # fmt: skip


def _through_the_hole(at: Local) -> ca.SX:
    q = at.position
    return at.p.c * q / ca.sqrt(ca.sqrt(q**2 + at.p.width**2) * at.p.h)


ORIFICE_LEAK = Effect(
    id="orifice_leak",
    kind="effort",
    title="leak through an orifice",
    equation="F = c sign(q) √(|q|/h),  sign(q) √|q| ≈ q/(q² + w²)^(1/4)",
    law=_through_the_hole,
    parameters=(
        EffectParameter("c", EFFORT, "flow where the level is h", guess=0.1, nests=True),
        HEIGHT,
        EffectParameter("width", POSITION, "rounding w at level zero", guess=1e-3, lower=0.0, fixed=True),
    ),
    source=(
        "Torricelli's law: White (2011), Fluid Mechanics, 7th ed.; in tanks: Schoukens, Mattsson, Wigren, "
        "Noël (2016), Cascaded tanks benchmark combining soft and hard nonlinearities"
    ),
    pattern=(
        "a loss that grows with the square root of the level; where the plant's own outlet at that level is "
        "free and nothing else receives its water, they are one"
    ),
    look_alikes=("linear_stiffness", "offset", "overflow"),
    separating_experiment=(
        "let the tank run empty from its highest level, with the inflow closed: the root of the level falls "
        "on a straight line over time, where a linear leak has an exponential"
    ),
    effort_units=FLOW_UNITS,
)
