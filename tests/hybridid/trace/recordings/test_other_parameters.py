"""On simulated carriages: the recordings that judge may have other parameters, which is told."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.trace.context import Context
from hybridid.trace.horizons.split import by_blocks, by_record
from hybridid.trace.recordings import between_recordings
from hybridid.trace.recordings.other_parameters import ASK, other_parameters
from hybridid.trace.refits.refit import WITHOUT_STD, refit
from hybridid.trace.rules import Rules

HORIZON = 50


@pytest.fixture(scope="module")
def said(two_records, make_model):
    """``said(f_c)``: what is told of the symmetric carriage whose friction is ``f_c`` where it is judged."""

    def make(judged: float, **there: float) -> str:
        (first, _), (_, second) = two_records(f_c=20.0), two_records(f_c=judged, **there)
        context = Context(by_record([first], [second], HORIZON), (), Rules())
        return other_parameters(refit(make_model(), context.split, std_up_to=WITHOUT_STD), context)

    return make


def test_a_friction_that_differs_between_the_recordings_is_told_with_both_values(said):
    told = said(20.6)
    here, there = (part.split(" ±")[0].split()[-1] for part in told.split("f_c = ")[1].split(", ")[:2])
    assert float(here) == pytest.approx(20.0, abs=0.1)
    assert float(there) == pytest.approx(20.6, abs=0.1)
    assert told.endswith(ASK)


def test_one_parameter_that_differs_is_told_and_no_gauge(said):
    """A payload is another mass. A gauge that reads less does nearly as well, and is not blamed."""
    told = said(20.0, M=105.0)
    assert " There M alone (M = 105.0" in told
    assert "gauge" not in told


def test_nothing_is_told_of_a_machine_with_the_same_parameters(said):
    assert said(20.0) == ""


def test_nothing_is_told_where_a_recording_is_on_both_sides(two_records, make_model):
    first, _ = two_records(f_c=20.0)
    context = Context(by_blocks([first], HORIZON), (), Rules())
    assert other_parameters(refit(make_model(), context.split), context) == ""


def test_a_law_that_no_other_parameters_make_up_for_is_not_told(said):
    """A spring where it is judged: no mass and friction moves as it does."""
    assert said(20.0, stiffness=2e3) == ""


@pytest.mark.parametrize(
    ("misread", "told", "value"),
    [("inputs", "force.input_gain", 1 / 1.12 - 1), ("outputs", "position.sensor_scale", 0.12)],
)
def test_one_gauge_that_reads_otherwise_where_it_is_judged_is_told(
    make_model, carriage, noise, misread, told, value
):
    """It reads 12 % too much there, so that all parameters seem to differ."""
    one, two = (carriage.record(1500, 0.002, noise(1500, 2e-6, seed=k), name=f"run{k}") for k in range(2))
    two = replace(two, **{misread: 1.12 * getattr(two, misread)}, warnings=())
    context = Context(by_record([one], [two], 150), (), Rules())
    said = other_parameters(refit(make_model(), context.split, std_up_to=WITHOUT_STD), context)
    _, found, rest = said.partition(f" There {told} alone (")
    assert found
    assert float(rest.split(" = ")[1].split()[0].replace("−", "-")) == pytest.approx(value, abs=0.01)
    assert said.endswith(ASK)


def test_it_is_told_once_how_to_ask(monkeypatch):
    monkeypatch.setattr(between_recordings, "other_parameters", lambda final, context: f" Told.{ASK}")
    monkeypatch.setattr(between_recordings, "_may_differ_by_recording", lambda found, context: ASK)
    found = SimpleNamespace(final=None)
    assert between_recordings._of_recordings(found, SimpleNamespace()) == f" Told.{ASK}"
    monkeypatch.setattr(between_recordings, "other_parameters", lambda final, context: "")
    assert between_recordings._of_recordings(found, SimpleNamespace()) == ASK
