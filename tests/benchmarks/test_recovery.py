"""Where the truth is the declared model, each case's own fit finds it again, in intervals worth having.

One draw of each; more come from ``make study-recovery``. Simulated.
"""

from __future__ import annotations

import pytest

from benchmarks import recovery

WIDEST = {"linear": 0.001, "coulomb_stribeck": 1.2, "dahl": 0.02, "lugre": 0.2, "half_car": 0.2}
"""Half width of the widest interval, over the truth, that the case may state."""
SURE = 3.5
"""Standard errors within which every one of some twenty parameters must lie; a true normal error misses
that in one run of a hundred. ``make study-recovery`` counts how many lie within 1.96."""


@pytest.mark.parametrize("case", recovery.CASES, ids=lambda case: case.name)
def test_the_truth_is_found_within_what_is_stated(case):
    rows = recovery.study(case, seed=1)
    assert {row.parameter for row in rows} == set(case.truth)
    assert rows[0].status.startswith("converged")
    for row in rows:
        assert abs(row.estimate - row.true) <= SURE * row.std, row
        assert row.width <= WIDEST[case.name], row
    assert sum(row.inside for row in rows) >= len(rows) - 1


def test_draws_start_apart():
    for case in recovery.CASES:
        model = recovery.model_of(recovery.configured(case, 0))
        starts = [[p.guess for p in recovery.scattered(model, seed).free] for seed in range(4)]
        for name, guesses in zip(case.truth, zip(*starts, strict=True), strict=True):
            assert max(guesses) > 1.1 * min(guesses), name


def test_an_interval_that_misses_is_said():
    row = recovery.Row("dahl", 0, "motor.dahl.s", "rad", 0.005, 0.0052, 0.00005, "converged", 1.0)
    assert not row.inside
    assert row.width == pytest.approx(1.96 * 0.01)
    assert "| NO | rad |" in recovery.table([row])
    assert "| dahl | 0 of 1 | 2.0% (motor.dahl.s) |" in recovery.table([row])
