"""Auxiliary channels: what a record measures beside inputs and outputs, seen by effects under its name."""

from __future__ import annotations

import pickle

import casadi as ca
import numpy as np
import pytest

from hybridid.declarations import Signal
from hybridid.effects.channel_friction import EFFECTS_OVER
from hybridid.effects.dimension import Dimension
from hybridid.effects.effect import Effect, EffectParameter
from hybridid.effects.library import library_for
from hybridid.model import Model, compose
from hybridid.plants.emps import EMPS
from hybridid.records.record import RecordError
from hybridid.simulation.matching import check_records

TEMPERATURE, PRESSURE = Signal("temperature", "°C"), Signal("pressure", "Pa")
WEAK_WHEN_HOT = Effect(
    id="weak_when_hot",
    kind="input",
    title="a drive that is weaker when it is hot",
    equation="u → (1 - a (temperature - 20 °C)) u",
    law=lambda at: -at.p.a * (at.channels.temperature - 20.0) * at.signal,
    parameters=(EffectParameter("a", Dimension(channel=-1, channel_unit="°C"), "loss", nests=True),),
    source="a test",
    pattern="none",
    channels=("temperature",),
)
AT = (0.0, [0.1, 0.2], [30.0, 35.0])
"""Time, states, and the force and temperature there."""


def test_the_level_of_friction_follows_the_channel():
    model = compose(EMPS(), ["friction_over_temperature"], channels=[TEMPERATURE])
    name = "carriage.friction_over_temperature"
    parameters = {p.name: p for p in model.parameters}
    assert (parameters[f"{name}.k"].unit, parameters[f"{name}.c_0"].unit) == ("N/°C", "°C")
    assert [p.name for p in model.free] == ["M", f"{name}.k"]
    for c_0, effort in ((25.0, 5.0), (40.0, -2.5)):
        values = model.values({f"{name}.k": 0.5, f"{name}.c_0": c_0})
        assert float(model.efforts(*AT, values)) == pytest.approx(effort)
    zero = model.values({f"{name}.c_0": 25.0})
    assert model.f(*AT, zero).elements() == Model(EMPS()).f(*AT[:2], AT[2][:1], zero[:1]).elements()
    slope = ca.Function("s", [p := ca.SX.sym("p", len(zero))], [ca.jacobian(model.f(*AT, p), p)])
    assert np.isfinite(np.asarray(slope(zero))).all()


def test_viscous_friction_follows_the_channel():
    model = compose(EMPS(), ["viscous_over_temperature"], channels=[TEMPERATURE])
    name = "carriage.viscous_over_temperature"
    parameters = {p.name: p for p in model.parameters}
    assert (parameters[f"{name}.k"].unit, parameters[f"{name}.c_0"].unit) == ("N·s/(m·°C)", "°C")
    values = model.values({f"{name}.k": 0.5, f"{name}.c_0": 25.0})
    assert float(model.efforts(*AT, values)) == pytest.approx(0.5 * (35.0 - 25.0) * 0.2)


def test_it_may_follow_an_input_of_the_plant():
    model = compose(EMPS(), ["friction_over_force"])
    values = model.values({"carriage.friction_over_force.k": 0.1})
    assert float(model.efforts(0, [0.1, 0.2], [30.0], values)) == pytest.approx(3.0)


def test_an_effect_on_a_path_sees_the_channel():
    model = Model(EMPS(), channels=(TEMPERATURE,)).plus(WEAK_WHEN_HOT, "force")
    values = {"M": 100.0, "force.weak_when_hot.a": 0.01}
    assert float(model.f(*AT, model.values(values))[1]) == pytest.approx(30.0 * (1 - 0.15) / 100.0)


@pytest.mark.parametrize("over", EFFECTS_OVER)
def test_model_and_effect_travel_to_another_process(over):
    effect = over(PRESSURE)
    assert pickle.loads(pickle.dumps(effect)) == effect
    model = compose(EMPS(), [effect], channels=[PRESSURE])
    back = pickle.loads(pickle.dumps(model))
    assert back.channels == (PRESSURE,)
    assert back.f(*AT, back.values()).elements() == model.f(*AT, model.values()).elements()


@pytest.mark.parametrize("over", EFFECTS_OVER)
def test_it_is_documented_as_the_rest_of_the_library(over):
    effect = over(TEMPERATURE)
    assert set(effect.look_alikes) <= {e.id for e in library_for([TEMPERATURE])}
    assert min(map(len, (effect.pattern, effect.separating_experiment))) >= 40
    assert all(p.meaning and p.name in effect.equation for p in effect.parameters)


def test_a_channel_that_the_model_lacks_costs_one_clear_line():
    model = Model(EMPS(), channels=(PRESSURE,))
    with pytest.raises(ValueError, match="allowed: force, pressure") as lacking:
        model.plus(WEAK_WHEN_HOT)
    assert "unknown channel that effect force.weak_when_hot sees 'temperature'" in str(lacking.value)
    with pytest.raises(ValueError, match="did you mean 'friction_over_pressure'"):
        compose(EMPS(), ["friction_over_presure"], channels=[PRESSURE])
    with pytest.raises(ValueError, match="channel force: two inputs or channels"):
        Model(EMPS(), channels=(Signal("force", "N"),))


def test_an_auxiliary_signal_becomes_a_channel_of_the_record(carriage_like):
    record = carriage_like(warming=0.5).record(100)
    seen = record.with_channels(["temperature"])
    assert [c.name for c in seen.input_channels] == ["force", "temperature"]
    assert not seen.input_channels[1].assumed
    assert np.array_equal(seen.input("temperature"), record.signal("temperature"))
    assert (seen.auxiliary, seen.auxiliary_channels) == (None, ())
    assert record.with_channels(()) is record
    with pytest.raises(
        RecordError, match=r"unknown auxiliary signal 'temprature': did you mean 'temperature'"
    ):
        record.with_channels(["temprature"])
    model = Model(EMPS(), channels=(TEMPERATURE,))
    check_records(model, [seen])
    with pytest.raises(
        ValueError, match="has the inputs force, plant emps with its channels needs force and temperature"
    ):
        check_records(model, [record])
