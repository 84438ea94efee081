"""The reference: bang-bang accelerations, exact parabolas, no limit exceeded."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.rigs.emps import REFERENCE
from hybridid.rigs.laws import RigError
from hybridid.rigs.trajectory import BangBang, Move

DT = 1e-3


def test_a_move_accelerates_cruises_and_brakes():
    plan = BangBang(lead_in=0.2, moves=(Move(0.1, 0.1, 1.0, rest=0.5), Move(0.0, 0.1, 1.0)))
    # ramp 0.1 s, cruise 0.9 s, ramp 0.1 s
    time = np.array([0.0, 0.2, 0.25, 0.3, 0.8, 1.3, 1.5, 1.8, 2.35])
    assert plan.position(time) == pytest.approx([0, 0, 0.00125, 0.005, 0.055, 0.1, 0.1, 0.1, 0.05], abs=1e-12)
    assert plan.period == pytest.approx(1.1 + 0.5 + 1.1)


def test_a_short_move_turns_round_before_it_reaches_its_speed():
    (ramp, a), (cruise, _), (_, brake), _ = Move(0.01, speed=5.0, acceleration=1.0).segments(0.0)
    assert (ramp, a, cruise, brake) == (pytest.approx(0.1), 1.0, pytest.approx(0.0), -1.0)


def test_the_reference_of_the_rig_keeps_its_limits_and_repeats():
    time = np.arange(0, 30, DT)
    q = REFERENCE.position(time)
    v, a = np.diff(q) / DT, np.diff(q, 2) / DT**2
    assert (q.min(), q.max()) == (pytest.approx(0.0, abs=1e-12), pytest.approx(0.245))
    assert np.abs(v).max() == pytest.approx(0.125, rel=1e-6)
    assert np.abs(a).max() <= 0.84 * (1 + 1e-6)
    assert np.isclose(np.abs(a), 0.84, rtol=1e-6).mean() > 0.1
    assert np.isclose(np.abs(a), 0.6, rtol=1e-6).mean() > 0.02
    assert not q[:100].any()
    assert REFERENCE.position(5.0 + REFERENCE.period) == pytest.approx(REFERENCE.position(5.0), abs=1e-12)


def test_three_seconds_hold_both_directions_at_several_speeds():
    v = np.diff(REFERENCE.position(np.arange(0, 3, DT))) / DT
    for speed in (0.042, -0.042, 0.083, 0.125):
        assert np.isclose(v, speed, rtol=1e-6).sum() > 50


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Move(0.1, 0.0, 1.0), "must be above 0"),
        (lambda: Move(0.1, 1.0, 1.0, rest=-1.0), "rest not below 0"),
        (lambda: BangBang(0.1, (Move(0.1, 1.0, 1.0),)), "must return"),
        (lambda: BangBang(0.1, ()), "must leave position 0"),
    ],
)
def test_a_reference_that_makes_no_sense_is_refused(make, said):
    with pytest.raises(RigError, match=said):
        make()
