"""Simulated carriages whose friction follows a recorded temperature: it is named, or its place is."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from hybridid.declarations import Signal
from hybridid.effects.channel_friction import friction_over
from hybridid.effects.dimension import EFFORT
from hybridid.effects.effect import Effect, EffectParameter
from hybridid.effects.library import EFFECTS, effect_named, library_for
from hybridid.effects.over import OVERS, Over, overs_for
from hybridid.plants.duffing import Duffing
from hybridid.plants.emps import EMPS
from hybridid.plants.esea import ESEA
from hybridid.plants.servo import Servo
from hybridid.trace.candidates import admissible
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import by_record
from hybridid.trace.ports.path import Path, is_load
from hybridid.trace.refits.refit import refit
from hybridid.trace.verdict import conclude

TEMPERATURE = Signal("temperature", "°C")
WARMING = 0.5  # N/K
OTHERS = tuple(map(effect_named, ("friction_drift", "position_friction", "stribeck")))
COLD_STICTION = Effect(
    id="cold_stiction",
    kind="effort",
    title="friction of a cold machine",
    equation="F = f sign(v) exp(-temperature / 10 °C)",
    law=lambda at: at.p.f * at.sign * ca.exp(-at.channels.temperature / 10),
    parameters=(EffectParameter("f", EFFORT, "level at 0 °C", nests=True),),
    source="a test",
    pattern="none",
    channels=("temperature",),
)


@pytest.fixture(scope="module")
def split(two_records):
    """Two records with their temperature as a channel."""
    first, second = (record.with_channels(["temperature"]) for record in two_records(warming=WARMING))
    return by_record([first], [second], 50)


@pytest.fixture(scope="module")
def model(make_model):
    return replace(make_model(), channels=(TEMPERATURE,))


def test_friction_that_follows_a_channel_is_named_with_the_channel(model, split):
    tried = (*OTHERS, friction_over(TEMPERATURE))
    found = conclude(model, Context(split, tried, variables=("velocity", "input")))
    assert found.verdict == "effect_found"
    (one,) = found.accepted
    assert one.name == "carriage.friction_over_temperature"
    values = one.trial.own("values")
    assert values["k"] == pytest.approx(WARMING, rel=0.02)
    assert values["c_0"] == pytest.approx(np.mean([r.input("temperature").mean() for r in split.records]))
    assert found.search.final.score.rmse == pytest.approx(2e-6, rel=0.1)


def test_a_learned_effort_over_the_channel_finds_it_where_no_effect_names_it(model, split):
    variables = ("velocity", "position", "time", "input")
    found = conclude(model, Context(split, OTHERS, laws=False, variables=variables))
    assert found.verdict == "unexplained"
    assert found.accepted == ()
    assert found.remains[0] == "at carriage over temperature, times sign of velocity"
    best = max(found.ceilings, key=lambda c: c.gain)
    assert (best.over_unit, best.over.channels) == ("°C", ("temperature",))
    seen = [temperature for temperature, _, _ in best.curve]
    assert (min(seen), max(seen)) == pytest.approx((17, 33), abs=1)


def test_without_a_channel_there_is_nothing_new(make_model, model):
    bare = make_model()
    assert library_for(bare.channels) == EFFECTS
    assert overs_for(EMPS().port("carriage"), ()) == OVERS
    tried = {c.name for c in admissible(bare, EFFECTS)}
    followed = library_for([TEMPERATURE])
    assert {c.name for c in admissible(bare, [*followed, COLD_STICTION])} == tried
    more = {c.name for c in admissible(model, [*library_for(model.channels), COLD_STICTION])} - tried
    both = {"carriage.friction_over_temperature", "carriage.viscous_over_temperature"}
    assert more == {*both, "carriage.cold_stiction"}


def test_a_channel_that_no_effect_sees_changes_no_number(make_model, model):
    bare = make_model()
    x, p = [0.1, -0.2], bare.values()
    assert [f.size1_in("u") for f in (bare.f, model.f)] == [1, 2]
    assert bare.f(0, x, [20.0], p).elements() == model.f(0, x, [20.0, 25.0], p).elements()


def test_an_input_is_a_place_of_a_learned_effort_unless_it_stands_still_or_is_the_load(model, split):
    overs = overs_for(model.plant.port("carriage"), model.plant.inputs, model.channels)[len(OVERS) :]
    assert [str(over) for over in overs] == [
        "force", "force, times sign of velocity", "force, times velocity",
        "temperature", "temperature, times sign of velocity", "temperature, times velocity",
    ]  # fmt: skip
    assert str(Over("input", signal=Signal("load", "N"))) == "input load"
    path = Path.of(refit(model, split), split, split.fitted)
    assert [path.shows("carriage", over) for over in overs] == [False] * 3 + [True] * 3
    still = replace(path, inputs=np.column_stack([path.inputs[:, 0], 0 * path.time + 25.0]))
    assert not any(still.shows("carriage", over) for over in overs)
    assert np.array_equal(path.seen("carriage", overs[3]), path.inputs[:, 1])


def test_the_variables_of_learned_efforts_can_be_narrowed(model, split):
    port = model.plant.port("carriage")
    every = overs_for(port, model.plant.inputs, model.channels)
    assert Context(split).overs(port, model) == list(every)
    narrowed = Context(split, variables=("position", "input")).overs(port, model)
    assert narrowed == [over for over in every if over.variable in ("position", "input")]
    assert {over.name for over in narrowed} > {"position", "temperature"}


@pytest.mark.parametrize(
    ("plant", "port", "name", "same"),
    [
        (EMPS(), "carriage", "force", True),
        (ESEA(), "motor", ESEA.inputs[0].name, False),
        (Servo(), Servo().equation_ports[0].name, "goal", False),
        (Duffing(), "oscillator", Duffing.inputs[0].name, False),
    ],
    ids=lambda given: getattr(given, "name", str(given)),
)
def test_an_input_may_be_the_load_of_a_port(plant, port, name, same):
    assert is_load(plant, port, name) is same
