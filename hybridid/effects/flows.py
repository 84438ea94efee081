"""Flows that leave a tank, or a volume of any kind: q is its level, F lowers it."""

from __future__ import annotations

import casadi as ca

from hybridid.effects.dimension import EFFORT, FREQUENCY, ONE, POSITION, STIFFNESS
from hybridid.effects.disturbance import AMPLITUDES, OVER_TIME, sine_over_time
from hybridid.effects.effect import Effect, EffectParameter, Local
from hybridid.effects.smooth import ramp

LIQUIDS = ("[!°K]*",)
"""Units of a level, not of a temperature: there the flow is heat, which has no edge and no hole."""
HEIGHT = EffectParameter(
    "h", POSITION, "reference height, fixed: it only sets what the coefficient means", guess=1.0, fixed=True
)

STEADY_LEAK = Effect(
    id="steady_leak",
    kind="flow",
    title="steady leak",
    equation="F = flow",
    law=lambda at: at.p.flow,
    parameters=(EffectParameter("flow", EFFORT, "flow that leaves; negative: that enters", nests=True),),
    source=(
        "a tank emptied by a pump of constant speed: Seborg, Edgar, Mellichamp (2004), Process Dynamics and "
        "Control, 2nd ed., ch. 2 (liquid storage systems)"
    ),
    pattern=(
        "the same loss at every level, with the inflow closed too; a dead zone of the pump takes it only "
        "while the pump runs"
    ),
    look_alikes=("linear_leak", "orifice_leak", "periodic_flow", "input_dead_zone"),
    separating_experiment=(
        "close all inflows at a high and at a low level: a steady leak lowers both by as much in the same "
        "time"
    ),
)

LINEAR_LEAK = Effect(
    id="linear_leak",
    kind="flow",
    title="leak in proportion to the level",
    equation="F = k q",
    law=lambda at: at.p.k * at.position,
    parameters=(EffectParameter("k", STIFFNESS, "flow over level: the conductance", lower=0.0, nests=True),),
    source=(
        "laminar flow through a long thin tube (Hagen-Poiseuille): White (2011), Fluid Mechanics, 7th ed., "
        "sec. 6.4; seepage through a porous wall (Darcy): Bear (1972), Dynamics of Fluids in Porous Media, "
        "ch. 5"
    ),
    pattern=(
        "a loss that doubles with the level, where that through an orifice grows by 1.4; the level that is "
        "left alone decays exponentially"
    ),
    look_alikes=("steady_leak", "orifice_leak", "overflow", "natural_convection"),
    separating_experiment=(
        "let the tank run empty from its highest level, with the inflow closed: the logarithm of the level "
        "falls on a straight line over time"
    ),
)


def _over_the_edge(at: Local) -> ca.SX:
    over = ramp(at.position - at.p.limit, at.p.width)
    return at.p.k * over * ca.sqrt(over / at.p.h)


_EDGE = (
    EffectParameter(
        "k", STIFFNESS, "flow over height, where the level is h above the edge", guess=1.0, lower=0.0,
        nests=True, hard=True,
    ),
    EffectParameter("limit", POSITION, "level of the edge", guess=0.8, lower=-5.0, upper=5.0, sought="place"),
    HEIGHT,
    EffectParameter("width", POSITION, "rounding of the edge", guess=1e-3, lower=0.0, fixed=True),
)  # fmt: skip

OVERFLOW = Effect(
    id="overflow",
    kind="flow",
    position_units=LIQUIDS,
    title="overflow over an edge",
    equation="F = k r √(r/h),  r = ramp(q - limit),  ramp(x) = 0 for x < 0, x for x > 0",
    law=_over_the_edge,
    parameters=_EDGE,
    source=(
        "Francis (1855), Lowell Hydraulic Experiments (rectangular weir); White (2011), Fluid Mechanics, 7th "
        "ed., sec. 10.7"
    ),
    pattern=(
        "nothing up to one level, then a flow that rises faster than the level; the level stays near the edge"
        " whatever more flows in"
    ),
    look_alikes=("linear_leak", "orifice_leak", "input_saturation", "overflow_into"),
    separating_experiment=(
        "fill slowly past the suspected edge with several inflows: the level stands above the edge by the "
        "inflow to the power 2/3, and below it nothing is lost"
    ),
)

OVERFLOW_INTO = Effect(
    id="overflow_into",
    kind="flow",
    position_units=LIQUIDS,
    title="overflow over an edge into another tank",
    equation=(
        "F = k r √(r/h) out of the first level,  share F into the second,  r = ramp(q - limit),  ramp(x) = 0"
        " for x < 0, x for x > 0"
    ),
    law=_over_the_edge,
    parameters=(
        *_EDGE,
        EffectParameter(
            "share", ONE, "share of the overflow that enters the second level", guess=0.5, lower=0.0,
            upper=2.0,
        ),
    ),
    into="share",
    source=(
        "Schoukens, Mattsson, Wigren, Noël (2016), Cascaded tanks benchmark combining soft and hard "
        "nonlinearities: part of what overflows enters the lower tank"
    ),
    pattern=(
        "above one level of the first tank the second one rises at once with the inflow, no longer through "
        "the outlet between them; with a share of 0 it is an overflow"
    ),
    look_alikes=("overflow", "linear_leak", "orifice_leak"),
    separating_experiment=(
        "fill slowly past the suspected edge, and collect what runs beside the second tank: it is what the "
        "first one loses less what the second one gains"
    ),
)  # fmt: skip


def _through_the_hole(at: Local) -> ca.SX:
    q = at.position
    return at.p.c * q / ca.sqrt(ca.sqrt(q**2 + at.p.width**2) * at.p.h)


ORIFICE_LEAK = Effect(
    id="orifice_leak",
    kind="flow",
    position_units=LIQUIDS,
    title="leak through an orifice",
    equation="F = c sign(q) √(|q|/h),  sign(q) √|q| ≈ q/(q² + w²)^(1/4)",
    law=_through_the_hole,
    parameters=(
        EffectParameter("c", EFFORT, "flow where the level is h", guess=0.1, lower=0.0, nests=True),
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
    look_alikes=("linear_leak", "steady_leak", "overflow"),
    separating_experiment=(
        "let the tank run empty from its highest level, with the inflow closed: the root of the level falls "
        "on a straight line over time, where a linear leak has an exponential"
    ),
)

PERIODIC_FLOW = Effect(
    id="periodic_flow",
    kind="flow",
    title="periodic flow",
    equation=OVER_TIME,
    law=sine_over_time,
    parameters=(
        *AMPLITUDES,
        EffectParameter(
            "frequency",
            FREQUENCY,
            "frequency of the flow",
            guess=1.0,
            lower=1e-3,
            upper=1000.0,
            starts=(0.1, 10.0),
            sought="frequency",
        ),
    ),
    source=(
        "the pulsating flow of a positive-displacement pump: White (2011), Fluid Mechanics, 7th ed., "
        "sec. 11.1; a draw that follows the time of day"
    ),
    pattern=(
        "one line in the spectrum of the level that is there with the inflow closed too, and does not care "
        "how high the level is"
    ),
    look_alikes=("steady_leak", "sensor_periodic_error"),
    separating_experiment=(
        "record a high and a low level with the inflow held, over ten periods each: the line keeps its "
        "frequency, its phase and its size"
    ),
)
