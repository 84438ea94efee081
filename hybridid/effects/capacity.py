"""A second capacity beside the one whose level is modelled: it fills and empties through a resistance."""

from __future__ import annotations

from hybridid.effects.dimension import POSITION, STIFFNESS, TIME
from hybridid.effects.effect import Effect, EffectParameter, EffectState

SIDE_CAPACITY = Effect(
    id="side_capacity",
    kind="flow",
    title="second capacity beside the first (wall, jacket, side tank)",
    equation="F = k d,  d' = q' - d/τ:  d = q - w, the second level w follows as τ w' = q - w;  capacity k τ",
    law=lambda at: at.p.k * at.z.d,
    dynamics=lambda at: {"d": at.rate - at.z.d / at.p.tau},
    parameters=(
        EffectParameter(
            "k",
            STIFFNESS,
            "conductance between both: flow over the difference",
            guess=0.3,
            lower=0.0,
            nests=True,
        ),
        EffectParameter(
            "tau",
            TIME,
            "time constant τ of the second capacity",
            guess=1.0,
            lower=0.01,
            upper=100.0,
            starts=(0.1, 10.0),
        ),
    ),
    states=(EffectState("d", POSITION, "how far the second level is behind the first"),),
    needs=("rate",),
    source=(
        "interacting processes: Seborg, Edgar, Mellichamp (2004), Process Dynamics and Control, 2nd ed., "
        "sec. 6.4; a wall that stores heat: Bacher, Madsen (2011), Energy and Buildings 43(7), 1511-1522"
    ),
    pattern=(
        "after a change of the inflow the level moves at once, and then creeps on; what a leak loses is "
        "lost, what a second capacity takes comes back"
    ),
    look_alikes=("linear_leak", "orifice_leak", "natural_convection", "sensor_lag", "input_lag"),
    separating_experiment=(
        "raise the level fast, close all flows, and wait: a second capacity lets the level sink to a new "
        "constant value, a leak to the surroundings'"
    ),
)
