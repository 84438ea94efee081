"""The times of delays and lags for records with longer samples."""

from __future__ import annotations

import pickle
from dataclasses import replace

import pytest

from hybridid.effects.library import EFFECTS, effect_named
from hybridid.effects.sampled import sampled


def named(effects, name):
    return next(effect for effect in effects if effect.id == name)


def parameter(effect, name):
    return next(p for p in effect.parameters if p.name == name)


def test_short_samples_change_nothing():
    assert sampled(EFFECTS, 1e-3) == EFFECTS
    assert sampled(EFFECTS, 1e-5) == EFFECTS


def test_a_delay_has_as_many_samples_whatever_they_last():
    delay = named(sampled(EFFECTS, 0.08), "input_delay")
    assert parameter(delay, "delay").upper == pytest.approx(0.8)
    assert parameter(delay, "window").guess == pytest.approx(0.8)
    assert parameter(delay, "window").starts == pytest.approx((0.4, 0.2))
    lag = named(sampled(EFFECTS, 0.08), "sensor_lag")
    assert (parameter(lag, "T").guess, parameter(lag, "floor").guess) == pytest.approx((0.16, 0.04))


def test_a_rate_limit_takes_as_many_samples_over_the_range():
    fast = parameter(effect_named("input_rate_limit"), "inverse_rate")
    slow = parameter(named(sampled(EFFECTS, 2.0), "input_rate_limit"), "inverse_rate")
    assert (slow.guess, slow.starts) == (pytest.approx(200.0), pytest.approx((40.0, 2000.0)))
    assert fast.guess == pytest.approx(0.1)


def test_all_else_stays_and_ones_own_effects_too():
    pairs = zip(EFFECTS, sampled(EFFECTS, 0.1), strict=True)
    changed = {effect.id for effect, one in pairs if effect is not one}
    assert changed == {"input_delay", "input_lag", "input_rate_limit", "sensor_lag", "input_record_lag"}
    mine = replace(effect_named("input_delay"), id="own_delay")
    assert sampled([mine], 0.1) == (mine,)


def test_each_can_be_sent_to_another_process():
    for effect in sampled(EFFECTS, 0.08):
        again = pickle.loads(pickle.dumps(effect))
        assert again.parameters == effect.parameters
