"""A sine counts as periodic only where the record shows that it repeats."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.refits.refit import refit
from hybridid.trace.starts.periodic import not_repeated
from hybridid.trace.starts.shown import not_shown


@pytest.fixture(scope="module")
def fitted(make_model, split_of):
    """``fitted("cogging", pitch=0.01)``: a candidate, and the model with it at these values."""
    split = split_of()
    base = refit(make_model(), split)

    def make(effect: str, port: str = "carriage", **own: float):
        candidate = Candidate(effect_named(effect), port)
        model = candidate.added_to(base.model)
        values = {**base.values, **candidate.starts(model, base.values)[0]}
        values |= {f"{candidate.name}.{name}": value for name, value in own.items()}
        return candidate, replace(base, model=model, values=values), split

    return make


def name_of(effect: str, sought: str) -> str:
    return next(p.name for p in effect_named(effect).parameters if p.sought == sought)


@pytest.mark.parametrize(("pitch", "shown"), [(0.001, True), (10.0, False)])
def test_a_period_as_long_as_the_stroke_is_a_bend(fitted, pitch, shown):
    why = not_repeated(*fitted("cogging", **{name_of("cogging", "period"): pitch}))
    assert (why == "") is shown
    if not shown:
        assert "3 are needed to show that it repeats" in why


@pytest.mark.parametrize(("period", "shown"), [(0.001, True), (10.0, False)])
def test_a_sensors_period_repeats_over_what_it_shows(fitted, period, shown):
    why = not_repeated(*fitted("sensor_periodic_error", "position", period=period))
    assert (why == "") is shown
    assert shown or "of its periods of 10 m" in why


@pytest.mark.parametrize(("hertz", "why"), [(10.0, ""), (150.0, "half the sampling"), (0.1, "are needed")])
def test_a_frequency_lies_between_three_periods_and_nyquist(fitted, hertz, why):
    frequency = name_of("periodic_disturbance", "frequency")
    said = not_repeated(*fitted("periodic_disturbance", **{frequency: hertz}))
    assert why in said
    assert (said == "") is (why == "")


def test_other_effects_need_no_period(fitted):
    assert not_repeated(*fitted("quadratic_drag")) == ""


@pytest.mark.parametrize(("periods", "shown"), [(0.9, False), (1.1, True)])
def test_a_resonance_swings_once_in_a_record(fitted, split_of, periods, shown):
    longest = max(record.n * record.dt for record in split_of().records)
    frequency = name_of("flexible_mode", "frequency")
    why = not_repeated(*fitted("flexible_mode", **{frequency: periods / longest}))
    assert (why == "") is shown
    assert shown or "shorter than one period" in why


@pytest.mark.parametrize(("d", "shown"), [(0.02, True), (-0.5, False)])
def test_a_stop_that_is_never_left_is_a_spring(fitted, d, shown):
    """The stroke is some centimetres about the middle."""
    why = not_shown(*fitted("end_stop", k=100.0, d=d))
    assert (why == "") is shown
    assert shown or why == "it acts in every fitted sample: the records do not show its edge"


@pytest.mark.parametrize(("tau", "shown"), [(0.0, True), (0.05, True), (100.0, False)])
def test_a_stop_that_damps_and_does_not_push_back_is_none(fitted, tau, shown):
    """A contact of some seconds, whose spring needs ``tau`` to push the machine back."""
    why = not_shown(*fitted("end_stop", k=1e-3, d=0.02, tau=tau))
    assert (why == "") is shown
    assert shown or why == "it damps and does not push back: the records show no stop"
