"""A column of the record that effects may see: from the config to what a trace would try."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import EFFECTS
from hybridid.records.record import RecordError
from hybridid.trace.candidates import admissible
from hybridid.trace.entries import Width
from pipelines.runner import run_stages
from pipelines.shared.augmented import augmented
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import load
from pipelines.shared.modelling import model_of
from pipelines.shared.prepared import prepared_records
from pipelines.trace.request import request_of

COLUMN = {"signals.auxiliary": {"temperature": {"column": "celsius", "unit": "°C"}}}
CHANNEL = {**COLUMN, "channels": {"temperature": "°C"}}


@pytest.fixture
def warm(data):
    """The data root, its records with a column of temperatures."""
    for path in data.glob("*.csv"):
        head, *rows = path.read_text().splitlines()
        celsius = np.linspace(20.0, 30.0, len(rows))
        lines = (f"{row},{c:.3f}" for row, c in zip(rows, celsius, strict=True))
        path.write_text("\n".join([f"{head},celsius", *lines, ""]))
    return data


def test_a_trace_would_try_what_follows_the_channel(settings):
    def candidates(changes):
        chosen = settings(changes)
        return {c.name for c in admissible(model_of(chosen), request_of(chosen).effects)}

    assert request_of(settings(COLUMN)).effects == EFFECTS
    new = candidates(CHANNEL) - candidates(COLUMN)
    friction = {"carriage.friction_over_temperature"}
    assert new == {*friction, "carriage.viscous_over_temperature"}
    assert candidates({**CHANNEL, "trace": {"effects": ["friction_over_temperature"]}}) == friction
    assert candidates({"trace": {"effects": ["friction_over_force"]}}) == {"carriage.friction_over_force"}


def test_a_fit_with_a_channel_can_be_read_again(settings, warm, heard):
    effect = "friction_over_temperature"
    chosen = {
        **CHANNEL,
        "effects": ["viscous", "coulomb", "offset", effect],
        "parameters.carriage": {effect: {"c_0": {"fixed": 25.0}}},
    }
    tree = run_stages(settings(chosen), "fit", heard).tree
    first = prepared_records(tree)[0]
    assert [signal.name for signal in first.inputs] == ["force", "temperature"]
    assert first.auxiliary == ()
    model, estimate = load(tree)
    assert [signal.name for signal in model.inputs] == ["force", "temperature"]
    assert {f"carriage.{effect}.k", "M"} <= set(estimate.values)
    assert estimate.values[f"carriage.{effect}.c_0"] == 25.0


def test_an_accepted_effect_over_a_channel_is_configured(settings):
    """As ``trace`` writes it into ``model.json``, with the mean of the channel kept."""
    (term,) = model_of(settings({**CHANNEL, "effects": ["friction_over_temperature"]})).terms
    values = {f"{term.name}.k": 0.5, f"{term.name}.c_0": 26.0}
    better = model_of(augmented(settings(CHANNEL), [term], {}, SimpleNamespace(values=values)))
    assert better.terms[-1].name == term.name
    found = {p.name: (p.guess, p.fixed) for p in better.parameters}
    assert (found[f"{term.name}.k"], found[f"{term.name}.c_0"]) == ((0.5, False), (26.0, True))


def test_a_smoothing_that_a_trace_made_narrower_is_configured(settings):
    width = Width("carriage.epsilon", "m/s", 1e-3, 2.5e-4)
    values = SimpleNamespace(values={})
    model = model_of(augmented(settings({"effects": ["viscous", "coulomb"]}), [], {}, values, [width]))
    assert {p.name: (p.guess, p.fixed) for p in model.parameters}["carriage.epsilon"] == (2.5e-4, True)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"effects": ["friction_over_temprature"]}, "did you mean 'friction_over_temperature'"),
        ({"trace": {"effects": ["friction_over_pressure"]}}, "unknown effect 'friction_over_pressure'"),
        ({"channels": ["temperature"]}, "give names with units, as in {temperature: °C}"),
        (
            {"channels": {}, "trace": {"extra_effects": ["lab:HEAT"]}},
            "unknown channel that effect heat of trace sees 'temperature': allowed: force",
        ),
    ],
)
def test_a_wrong_name_costs_one_clear_line(settings, own_folder, monkeypatch, changes, line):
    (own_folder / "lab.py").write_text(OWN)
    monkeypatch.syspath_prepend(str(own_folder))
    chosen = settings({**CHANNEL, **changes})
    with pytest.raises(ConfigError) as wrong:
        model_of(chosen), request_of(chosen)
    assert line in str(wrong.value)
    assert "\n" not in str(wrong.value)


def test_a_channel_that_the_records_lack_costs_one_clear_line(settings, warm, heard):
    chosen = settings({**COLUMN, "channels": {"celsius": "°C"}})
    with pytest.raises(RecordError, match=r"record first: unknown auxiliary signal 'celsius'.*: temperature"):
        run_stages(chosen, "preprocess", heard)
    with pytest.raises(ValueError, match="temperature is in °C, plant emps with its channels needs K"):
        run_stages(settings({**COLUMN, "channels": {"temperature": "K"}}), "fit", heard)


OWN = """
from hybridid.effects.dimension import EFFORT
from hybridid.effects.effect import Effect, EffectParameter

HEAT = Effect(
    id="heat", kind="effort", title="heat", equation="F = f temperature sign(v)",
    law=lambda at: at.p.f * at.channels.temperature * at.sign,
    parameters=(EffectParameter("f", EFFORT, "level", nests=True),),
    source="a test", pattern="none", channels=("temperature",),
)
"""
