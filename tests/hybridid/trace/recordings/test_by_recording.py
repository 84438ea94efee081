"""A parameter that differs by recording is named; a drift within each run is told apart. Simulated."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.entries import DifferingParameter, Floor, Value
from hybridid.trace.horizons.split import by_blocks, by_record
from hybridid.trace.recordings.by_recording import by_recording
from hybridid.trace.rules import Rules
from hybridid.trace.search.search import search
from hybridid.trace.trials.trial import PASSED, REJECTED
from hybridid.trace.words.recording_words import by_recording_in_words, comes_first
from hybridid.trace.words.words import sentence

F_C, DRIFT = "carriage.coulomb.f_c", "carriage.friction_drift"
GAUGES = {"force.input_gain.g", "position.sensor_scale.e"}
TRIED = tuple(map(effect_named, ("friction_drift", "stribeck")))
HORIZON = 25


@pytest.fixture(scope="module")
def pair(two_records):
    """``pair(f_c of the first, of the second)``: two recordings."""

    def make(f_first, f_second):
        return two_records(f_c=f_first)[0], two_records(f_c=f_second)[1]

    return make


@pytest.fixture(scope="module")
def searched(make_model):
    def make(records, rules=None, model=None):
        context = Context(by_blocks(records, HORIZON), TRIED, rules or Rules())
        return search(model or make_model(), context, [{}]), context

    return make


def differing(found, context):
    return [one for one in by_recording(found, context) if one.status == PASSED]


def test_friction_that_differs_is_named_with_its_values(pair, searched):
    found, context = searched(pair(20.0, 21.5))
    assert not found.accepted
    (one,) = differing(found, context)
    assert one.parameter == F_C
    assert one.gain > 0.5
    assert one.p_value < Rules.alpha
    for record, truth in (("first", 20.0), ("second", 21.5)):
        value = one.values[record]
        assert abs(value.value - truth) < 4 * value.std
    assert one.held_out_rmse["position"] < 0.5 * found.final.score.rmse[0]
    others = [t for t in by_recording(found, context) if t.status != PASSED]
    assert {t.parameter for t in others} == {p.name for p in found.final.model.free} - {F_C} | GAUGES


def test_a_gauge_that_reads_too_much_in_one_recording_is_named_with_what_puts_it_right(pair, searched):
    """It reads 12 % too much in the second: mass and friction seem to differ there."""
    first, second = pair(20.4, 20.4)
    found, context = searched((first, replace(second, inputs=1.12 * second.inputs, warnings=())))
    tried = by_recording(found, context)
    one = next(t for t in tried if t.status == PASSED and not t.in_place_of)
    assert one.parameter == "force.input_gain.g"
    assert one.values["first"] == Value(0.0, 0.0, "1")
    assert one.values["second"].value == pytest.approx(1 / 1.12 - 1, abs=3e-3)
    floor = {"position": Floor(1.0, "m")}
    said = by_recording_in_words(SimpleNamespace(by_recording=tried, rules=Rules(), noise_floor=floor))
    assert "another range, which the step scale of force by 0.89" in said
    assert " in second puts right." in said
    assert " in second against first: that leaves" in said


def test_one_parameter_that_differs_is_named_before_the_gauge_that_explains_as_much(
    two_records, make_model, searched
):
    """Of a mass without friction, a gauge that reads less is the exact equal of a payload."""
    bare = {"f_v": 0.0, "f_c": 0.0, "offset": 0.0}
    records = two_records(M=95.0, **bare)[0], two_records(M=105.0, **bare)[1]
    found, context = searched(records, model=make_model(()))
    (one,) = differing(found, context)
    assert one.parameter == "M"
    assert "force.input_gain.g" in one.alike
    assert one.values["second"].value == pytest.approx(105.0, abs=0.5)


def test_two_that_differ_are_both_named(two_records, searched):
    records = two_records(f_c=20.0, M=95.0)[0], two_records(f_c=21.5, M=110.0)[1]
    found, context = searched(records)
    assert {one.parameter for one in differing(found, context)} == {F_C, "M"}


def test_where_nothing_differs_nothing_is_named(pair, searched):
    assert differing(*searched(pair(20.4, 20.4))) == []


def test_a_drift_within_each_run_is_none(pair, searched):
    """Friction that rises in each run alike: the effect names it, and no parameter differs."""
    found, context = searched(tuple(drifting(record) for record in pair(20.4, 20.4)))
    assert [one.name for one in found.accepted] == [DRIFT]
    assert differing(found, context) == []


def test_a_drift_that_stands_for_a_step_is_said_to(pair, searched):
    """The second run is recorded an hour later: a line through two levels of friction fits as well."""
    first, second = pair(20.0, 22.0)
    found, context = searched((first, replace(second, time=second.time + 3600.0)))
    assert [one.name for one in found.accepted] == [DRIFT]
    assert (F_C, DRIFT) in [(one.parameter, one.in_place_of) for one in differing(found, context)]


def test_a_parameter_with_groups_already_is_not_tried(pair, searched, make_model):
    groups = {F_C: ("a", "b")}
    model = replace(make_model(), groups=groups)
    weights = ({f"{F_C}[a]": 1.0, f"{F_C}[b]": 0.0}, {f"{F_C}[a]": 0.0, f"{F_C}[b]": 1.0})
    records = tuple(
        record.with_constants(own, dict.fromkeys(own, "1"))
        for record, own in zip(pair(20.0, 21.5), weights, strict=True)
    )
    tried = by_recording(*searched(records, model=model))
    assert {one.parameter for one in tried} - GAUGES == {
        "M",
        "carriage.viscous.f_v",
        "carriage.offset.offset",
    }
    assert not any(one.status == PASSED for one in tried)


def test_a_record_that_is_held_out_as_a_whole_cannot_judge(pair, make_model):
    first, second = pair(20.0, 21.5)
    context = Context(by_record([first], [second], HORIZON), TRIED)
    found = search(make_model(), context, [{}])
    with pytest.raises(ValueError, match="judged on alternate horizons of two records or more"):
        by_recording(found, context)


def drifting(record):
    """As if the Coulomb friction had risen by 0.8 N a second: the force that it takes is missing."""
    velocity = np.gradient(record.outputs[:, 0], record.time)
    more = 0.8 * record.time * np.tanh(velocity / 3e-3)
    return replace(record, inputs=record.inputs + more[:, None])


def in_words(gain, p_value):
    """A mass that was tried in the place of a lag."""
    values = {"first": Value(309.0, 0.1, "kg"), "second": Value(425.7, 0.1, "kg")}
    mass = DifferingParameter(
        "M", PASSED, "its reason", gain, p_value, values, {}, in_place_of="position.sensor_lag"
    )
    said = by_recording_in_words(SimpleNamespace(by_recording=(mass,), rules=Rules()))
    return said.replace("\N{NO-BREAK SPACE}", " ")


def test_a_parameter_that_explains_more_in_the_place_of_an_effect_refutes_that_name():
    said = in_words(0.98, 1e-6)
    assert said.startswith(
        " But M that differs by recording, 309.00 ± 0.20 kg in first and 425.70 ± 0.20 kg in"
    )
    assert "leaves 98.0 % less error in the place of position.sensor_lag" in said
    assert "that name is refuted. parameters.M.by=record fits each." in said
    assert in_words(0.01, 1.0) == (
        " These records cannot tell position.sensor_lag from M that differs by recording."
    )


@pytest.mark.parametrize(("status", "leads"), [(PASSED, True), (REJECTED, False)])
def test_where_no_effect_was_found_what_differs_comes_first(nothing, status, leads):
    values = {"first": Value(14.7, 0.02, "N"), "second": Value(15.2, 0.02, "N")}
    friction = DifferingParameter("carriage.coulomb.f_c", status, "its reason", 0.84, 1e-9, values, {})
    said = sentence(replace(nothing(), verdict="unexplained", times=15.0, by_recording=(friction,)))
    assert said.startswith("carriage.coulomb.f_c differs by recording, 14.700") is leads
    assert ("With one value for all recordings: Something is missing" in said) is leads


@pytest.mark.parametrize(("gain", "first"), [(0.98, True), (0.0, False)])
def test_where_each_name_is_refuted_what_differs_comes_first(gain, first):
    """Not where it explains as much as the name, in its place."""
    mass = DifferingParameter("M", PASSED, "its reason", 0.9, 1e-6, {}, {})
    instead = replace(mass, gain=gain, in_place_of="position.sensor_lag")
    accepted = (SimpleNamespace(name="position.sensor_lag"),)
    found = SimpleNamespace(by_recording=(mass, instead), accepted=accepted, rules=Rules())
    assert comes_first(found) is first
    assert not comes_first(SimpleNamespace(by_recording=(instead,), accepted=accepted, rules=Rules()))


@pytest.mark.parametrize(("left", "open_still"), [(2e-6, False), (2e-5, True)])
def test_a_parameter_may_only_seem_to_differ_where_much_is_still_missing(nothing, left, open_still):
    values = {"first": Value(5.0, 0.05, "kg"), "second": Value(4.64, 0.05, "kg")}
    mass = DifferingParameter("M", "passed", "", 0.35, 1e-14, values, {"position": left})
    said = sentence(replace(nothing(), verdict="unexplained", times=15.0, by_recording=(mass,)))
    bent = "so M may be the same in all, and what is missing bends it another way in each."
    assert (bent in said) is open_still
    exact = {"position": Floor(0.0, "m")}
    silent = replace(nothing(), verdict="unexplained", times=15.0, by_recording=(mass,), noise_floor=exact)
    assert bent in sentence(silent), "a record without noise shows all that is left"
