"""A simulated tank that overflows is traced in the words of a level: net flow, learned and missing flow."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.declarations import Signal
from hybridid.effects.library import effect_named
from hybridid.effects.over import OVERS_OF_A_FLOW, Over, overs_for
from hybridid.model import compose
from hybridid.plotting.trace_ceiling import LearnedCurve, ceiling_plot
from hybridid.plotting.trace_missing_effort import missing_effort_plot
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import by_record
from hybridid.trace.learned.learned_effort import learned_effort
from hybridid.trace.ports.missing_effort import missing_effort
from hybridid.trace.verdict import conclude
from hybridid.trace.words.summary import learned_gains

WEIR, EDGE, DEPTH, OUTLET = 0.04, 0.4, 0.3, 6e-4
TRIED = tuple(map(effect_named, ("overflow", "linear_leak", "viscous", "end_stop")))
TRUTH = {"tank.orifice_leak.c": OUTLET * np.sqrt(DEPTH)}


@pytest.fixture(scope="module")
def records(leaking):
    spilling = leaking(weir=WEIR, edge=EDGE, c=OUTLET)
    return [spilling.record(300, 3e-4, seed=1), spilling.record(300, 3e-4, seed=2, fast=1.3)]


@pytest.fixture(scope="module")
def found(tank, records):
    return conclude(compose(tank, ["orifice_leak"]), Context(by_record(records[:1], records[1:], 20), TRIED))


@pytest.fixture(scope="module")
def missing(tank, records):
    return missing_effort(compose(tank, ["orifice_leak"]), TRUTH, records[1], "tank")


def test_the_overflow_is_named_and_nothing_mechanical_is_tried(found):
    assert found.verdict == "effect_found"
    (one,) = found.accepted
    assert one.name == "tank.overflow"
    values = one.trial.own("values")
    assert values["k"] == pytest.approx(WEIR * np.sqrt(DEPTH), rel=0.03)
    assert values["limit"] == pytest.approx(EDGE, abs=2e-3)
    assert {t.candidate.effect.id for t in found.search.steps[0].trials} == {"overflow", "linear_leak"}


def test_nothing_is_smoothed_so_no_smoothing_is_varied(found):
    (one,) = found.accepted
    assert [s.variation for s in one.survivals] == ["half the step", "integrator rodas3"]


def test_flows_are_learned_over_what_a_level_has(found):
    assert {str(c.over): c.over_unit for c in found.ceilings} == {
        "level": "m", "time": "s", "level, times net flow": "m", "level, times drive": "m",
        "inflow": "m³/s",
    }  # fmt: skip
    assert found.ceilings[0].described == "a learned flow at tank over level"
    gains = learned_gains(found.ceilings)
    assert {one.kind for one in gains} == {"flow"}
    assert {one.over: one.unit for one in gains} == {
        "level": "m³/s", "time": "m³/s", "inflow": "m³/s",
        "level, times net flow": "m²", "level, times drive": "1",
    }  # fmt: skip


def test_a_level_has_no_velocity_load_or_friction_to_learn_over(tank):
    overs = overs_for(tank.port("tank"), [Signal("inflow", "m³/s")])
    ours = ["level", "time", "level, times net flow", "level, times drive"]
    assert [str(over) for over in overs] == [*ours, "inflow"]
    assert overs[:-1] == OVERS_OF_A_FLOW
    assert str(Over("input", signal=Signal("level", "m"))) == "input level"


def test_a_section_that_varies_with_the_level_is_learned_as_a_factor_of_the_net_flow(tank):
    effect = learned_effort("flow", Over("level", "net flow"), np.linspace(0.0, 0.5, 50))
    model = compose(tank, [effect])
    assert {p.unit for p in model.parameters if p.name.startswith(f"tank.{effect.id}.a")} == {"m²"}
    values = model.values({f"tank.{effect.id}.a0": 0.01})
    once, twice = (float(model.efforts(0, [0.2], [inflow], values)) for inflow in (1e-3, 2e-3))
    assert twice == pytest.approx(2 * once)
    assert once != 0.0


def test_the_missing_flow_is_what_flows_over_the_edge(missing):
    level, unit = missing.motion["level"]
    assert set(missing.motion) == {"level", "net flow"}
    assert (unit, missing.kind, missing.unit) == ("m", "flow", "m³/s")
    spilled = WEIR * np.maximum(level - EDGE, 0.0) ** 1.5
    assert spilled.max() > 2e-4
    assert np.sqrt(np.mean((missing.effort - spilled)[5:-5] ** 2)) < 0.1 * spilled.max()


def test_a_sensor_lacks_no_flow(tank, records):
    with pytest.raises(ValueError, match="port level is of kind output"):
        missing_effort(compose(tank, ["orifice_leak"]), TRUTH, records[0], "level")


def test_figures_speak_of_levels_and_flows(missing):
    plot = missing_effort_plot({"gray box": missing}, {"inflow": (np.linspace(0.0, 1e-3, 300), "m³/s")})
    labels = {axes.get_xlabel().split(" [")[0] for axes in plot.figure.axes}
    assert labels == {"time", "level", "net flow", "inflow"}
    assert {axes.get_ylabel().split(" [")[0] for axes in plot.figure.axes} - {""} == {"missing flow"}
    assert plot.caption.startswith("Flow that leaves at tank on tank (simulated)")
    at, flow = np.linspace(0, 0.5, 9), np.linspace(0, 1e-4, 9)
    curve = LearnedCurve("gray box", "level", at, flow, np.full(9, 30), "m³/s", "m", 0.5, kind="flow")
    drawn = ceiling_plot("tank", [curve], "held out", "simulated")
    assert drawn.figure.axes[0].get_ylabel().startswith("learned flow")
    assert drawn.caption.startswith("Flow at tank (simulated) learned")
