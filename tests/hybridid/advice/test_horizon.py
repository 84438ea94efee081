"""How long a horizon should be is told where it is not. All records here are simulated."""

from __future__ import annotations

import pytest

from hybridid.advice.horizon import proposed_horizon
from hybridid.estimators import FitSettings, fit
from hybridid.quality import judge


def told(model, record, samples):
    """What is advised of a fit over horizons of so many samples."""
    estimate = fit(model, [record], FitSettings(horizon=samples))
    return [one.said for one in judge(model, [record], estimate).advice if one.kind == "horizon"]


@pytest.mark.parametrize(
    ("samples", "begins"),
    [
        (30, "estimator.horizon=30 is 0.15 s, shorter than the slowest dynamics that the records resolve"),
        (200, None),
        (None, None),
        (2000, "estimator.horizon=2000 is 10 s, longer than a tenth of all that is fitted (30 s)"),
    ],
)
def test_a_horizon_that_does_not_suit_its_records_is_told(make_model, carriage, samples, begins):
    long = carriage.record(n=6000)
    said = told(make_model(), long, samples)
    assert len(said) == (begins is not None)
    if begins:
        assert "(0.47 s)" in said[0] or samples == 2000
        assert said[0].startswith(begins)
        assert "estimator.horizon=200 (1 s)" in said[0]


def test_several_records_leave_enough_of_a_longer_horizon(make_model, carriage):
    """Fifteen of 2 s are left of three records of 10 s; a tenth of one is 1 s."""
    long = carriage.record(n=6000)
    records = [long.part(k, k + 2000, name=f"part {k}") for k in (0, 2000, 4000)]
    estimate = fit(make_model(), records, FitSettings(horizon=400))
    assert [one for one in judge(make_model(), records, estimate).advice if one.kind == "horizon"] == []


@pytest.mark.parametrize("samples", [200, 600, 1000, 2000])
def test_no_horizon_is_too_long_and_the_one_that_is_proposed_too_short(make_model, carriage_like, samples):
    """The slowest dynamics take 5 s, a sixth of the record."""
    slow = carriage_like(f_v=190.0, M=950.0, f_c=0.0, offset=0.0).record(n=6000)
    (said,) = told(make_model(("viscous",)), slow, samples) or [""]
    assert ("longer than a tenth" in said) is (samples == 2000)
    assert ("estimator.horizon=600 (3 s) is proposed" in said) is (samples in (200, 2000))


@pytest.mark.parametrize("samples", [51, 60])
def test_a_longer_horizon_is_proposed_only_where_it_helps(make_model, carriage, samples):
    """The slowest dynamics take 0.47 s; a tenth of 2.6 s is 52 samples, which show little more."""
    (said,) = told(make_model(), carriage.record(n=521), samples)
    assert said.startswith(
        f"estimator.horizon={samples} is {0.005 * samples:.3g} s, shorter than the slowest"
    )
    assert "these records are too short for a longer one" in said
    assert said.count("estimator.horizon=") == 2
    assert "estimator.horizon=null" in said


def test_the_proposed_horizon_is_a_second_fifty_samples_or_a_tenth():
    assert proposed_horizon(1e-3, 24.8) == 1.0
    assert proposed_horizon(1.0, 4000.0) == 50.0
    assert proposed_horizon(1e-3, 3.0) == 0.3


def test_a_horizon_has_twenty_samples_where_the_record_allows_it():
    assert proposed_horizon(0.02, 1.0) == 0.4
    assert proposed_horizon(0.02, 0.6) == 0.3


def test_a_horizon_as_long_as_the_slowest_dynamics_to_two_digits_is_not_told(make_model, carriage):
    """They take 0.47 s; 93 samples are 0.465 s."""
    assert told(make_model(), carriage.record(n=2000), 93) == []
    assert told(make_model(), carriage.record(n=2000), 90) != []
