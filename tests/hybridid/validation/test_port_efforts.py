"""The effort at a port, from the model and from the record, against what was put in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.dimension import Dimension
from hybridid.effects.effect import Effect, EffectParameter
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.records.record import Channel, Record
from hybridid.simulation.simulate import simulate
from hybridid.validation import free_run
from hybridid.validation.port_efforts import port_efforts, resisting_effort

TRUTH = {
    "M": 90.0,
    "carriage.viscous.f_v": 200.0,
    "carriage.coulomb.f_c": 20.0,
    "carriage.offset.offset": -3.0,
    "carriage.epsilon": 5e-3,
}
EFFECTS = ["viscous", "coulomb", "offset"]
SPRING = Effect(
    id="spring", kind="effort", title="spring", equation="F = k q", law=lambda at: at.p.k * at.position,
    parameters=(EffectParameter("k", Dimension(effort=1, position=-1), "stiffness", nests=True),),
    source="a test", pattern="grows with position",
)  # fmt: skip


@pytest.fixture(scope="module")
def record() -> Record:
    """A smooth force on the true carriage, without noise."""
    time = 1e-3 * np.arange(3000)
    force = 60.0 * np.sin(2 * np.pi * 0.5 * time) + 15.0 * np.sin(2 * np.pi * 1.3 * time)
    blank = Record(
        "made", time, force[:, None], np.sin(time)[:, None],
        (Channel("force", "N"),), (Channel("position", "m"),), simulated=True,
    )  # fmt: skip
    truth = simulate(compose(EMPS(), EFFECTS), TRUTH, blank, np.array([0.0, 0.0]))
    return replace(blank, outputs=truth.outputs, warnings=())


def test_record_gives_the_effort_that_was_put_in(record):
    """Even where the model knows only a part of it: the sum comes from the record."""
    model = compose(EMPS(), ["viscous"])
    velocity, effort = resisting_effort(model, {"M": 90.0}, record, model.plant.port("carriage"))
    put_in = 200.0 * velocity + 20.0 * np.tanh(velocity / 5e-3) - 3.0
    sliding = np.abs(velocity) > 0.03
    assert sliding.sum() > 1000
    np.testing.assert_allclose(effort[sliding], put_in[sliding], atol=0.5)


def test_model_gives_its_efforts_by_effect(record):
    model = compose(EMPS(), EFFECTS)
    prediction = free_run(model, TRUTH, record)
    (at,) = port_efforts(model, TRUTH, record, prediction)
    assert at.port.name == "carriage"
    assert at.static
    np.testing.assert_allclose(at.over, prediction.states[:, 1])
    np.testing.assert_allclose(at.efforts["carriage.viscous"], 200.0 * at.over)
    np.testing.assert_allclose(at.efforts["carriage.offset"], -3.0)
    total = sum(at.efforts.values())
    velocity, effort = resisting_effort(model, TRUTH, record, at.port)
    inner = slice(25, len(total) - 25)
    sliding = np.abs(velocity) > 0.03
    np.testing.assert_allclose(total[inner][sliding], effort[sliding], atol=0.5)


def test_effort_of_position_is_no_curve_over_velocity(record):
    model = compose(EMPS(), ["viscous", SPRING])
    values = {"M": 90.0, "carriage.spring.k": 50.0, "carriage.viscous.f_v": 200.0}
    prediction = free_run(model, values, record)
    (at,) = port_efforts(model, values, record, prediction)
    assert not at.static
    np.testing.assert_allclose(at.efforts["carriage.spring"], 50.0 * prediction.states[:, 0])


def test_state_that_nothing_observes_gives_no_effort(record):
    model = compose(EMPS(), ["dahl"])
    assert resisting_effort(model, {"M": 90.0}, record, model.plant.port("carriage")) is None


def test_at_a_level_the_record_gives_the_flow_that_leaves(tank, leaking):
    """Over the level, from a model that knows nothing of the outlet."""
    record = leaking(c=6e-4).record()
    level, flow = resisting_effort(compose(tank), {}, record, tank.port("tank"))
    np.testing.assert_allclose(level, record.outputs[25:-25, 0], atol=5e-3)
    assert np.ptp(level) > 0.3
    np.testing.assert_allclose(flow, 6e-4 * np.sqrt(level), rtol=0.05)


def test_at_a_level_the_model_gives_its_flows_over_the_level(tank, leaking):
    record = leaking().record(200)
    model = compose(tank, ["orifice_leak", "linear_leak"])
    values = {"tank.orifice_leak.c": 3e-4, "tank.linear_leak.k": 2e-4}
    prediction = free_run(model, values, record)
    (at,) = port_efforts(model, values, record, prediction)
    assert at.static
    np.testing.assert_allclose(at.over, prediction.states[:, 0])
    np.testing.assert_allclose(at.efforts["tank.linear_leak"], 2e-4 * at.over)
