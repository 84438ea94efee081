"""The study of planted blunders on a few draws of its own seed, never on those that judge. All simulated."""

from __future__ import annotations

import pytest

from benchmarks.blunders.draw import DEVELOPED, JUDGED, KINDS, SOUND, drawn
from benchmarks.blunders.play import Outcome, played
from benchmarks.blunders.report import table


def test_draws_are_fixed_and_those_that_judge_are_others():
    assert JUDGED != DEVELOPED
    first, again = (drawn("sign", 1, DEVELOPED) for _ in range(2))
    assert first.planted == again.planted
    assert (first.records[0].outputs == again.records[0].outputs).all()
    assert all(record.simulated for record in first.records)


@pytest.mark.parametrize(("kind", "number"), [("sign", 1), ("sign", 3)])
def test_a_blunder_is_told_with_its_cause(kind, number):
    outcome = played(kind, number, DEVELOPED)
    assert outcome.told
    assert outcome.cause


def test_a_sound_draw_is_not_accused():
    assert not played(SOUND, 7, DEVELOPED).told


def test_shares_are_counted():
    rows = [Outcome(k, 0, "emps", "x", "wrong", (k,)) for k in KINDS] + [
        Outcome(SOUND, 0, "emps", "", "sound", ())
    ]
    text = table(rows)
    assert "simulated" in text.lower()
    assert "told: 5 of 5" in text
    assert "false alarms: 0 of 1" in text
