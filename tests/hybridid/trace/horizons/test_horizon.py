"""The length of the horizons, where it is left open."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.trace.horizons.horizon import horizon_for
from hybridid.trace.horizons.split import ENOUGH, FEW, LONGEST, SAMPLES, automatic_horizon


def test_twice_the_slowest_dynamics_fit_in_where_enough_are_left():
    assert automatic_horizon([100.0], [100.0], 1.0, slowest=3.0) == 6.0
    assert automatic_horizon([100.0], [100.0], 1.0, slowest=0.2) == 1.0
    assert automatic_horizon([100.0], [100.0], 1.0, slowest=8.0) == 100.0 / ENOUGH


def test_once_where_only_few_are_left_and_not_more():
    assert automatic_horizon([100.0], [100.0], 1.0, slowest=12.0) == 12.0
    assert automatic_horizon([100.0], [100.0], 1.0, slowest=30.0) == pytest.approx(100.0 / FEW)


def test_a_horizon_holds_some_samples():
    assert automatic_horizon([100.0], [], 1.0, step=5.0) == SAMPLES * 5.0


def test_a_fast_machine_keeps_the_usual_horizon_and_a_slow_one_gets_a_longer_one(make_model, carriage):
    """The carriage's own time constant is M / f_v."""
    model, records = make_model(), 2 * [carriage.record(n=3000, dt=0.02)]
    start = {p.name: p.guess for p in model.parameters}
    fast = {**start, "M": 90.0, "carriage.viscous.f_v": 200.0}
    slow = {**start, "M": 90.0, "carriage.viscous.f_v": 30.0}
    assert horizon_for(model, fast, records[:1], records[1:]) == LONGEST
    assert horizon_for(model, slow, records[:1], records[1:]) == pytest.approx(2 * 90.0 / 30.0, rel=0.02)


def test_where_nothing_drives_the_machine_horizons_are_as_long_as_enough_are_left(make_model, carriage):
    model, record = make_model(), carriage.record(n=3000, dt=0.02)
    still = replace(record, inputs=np.zeros_like(record.inputs))
    start = {p.name: p.guess for p in model.parameters}
    seconds = record.n * record.dt
    found = horizon_for(model, start, [still], [still])
    assert found == pytest.approx(seconds / FEW, rel=0.05)


def test_an_unstable_machine_gets_horizons_over_which_an_error_grows_by_e_to_the_fifth(make_model, carriage):
    """A carriage on a hill-top: it falls with the rate √(k/M)."""
    model, records = make_model(("viscous", "linear_stiffness")), 2 * [carriage.record(n=3000)]
    mass = {"M": 90.0, "carriage.viscous.f_v": 0.0}
    hill, slope = ({**mass, "carriage.linear_stiffness.k": -90.0 * rate**2} for rate in (40.0, 15.0))
    assert horizon_for(model, hill, records[:1], records[1:]) == pytest.approx(5.0 / 40.0, rel=0.05)
    assert horizon_for(model, slope, records[:1], records[1:]) == LONGEST
