"""The benchmark of the speed: ways take turns, reach the same, and a failure is told."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.speed import fits
from benchmarks.speed.contest import Way, contest
from benchmarks.speed.emps import Contested, contested, like_emps
from benchmarks.speed.fits import BESIDE
from benchmarks.speed.report import write_report
from benchmarks.speed.rivals import by_every_sample, by_jax_sysid, by_numba
from benchmarks.speed.row import OURS, Row


@pytest.fixture(scope="module")
def short():
    """0.6 s of a simulated EMPS."""
    return Contested(contested(200, "data=simulated").model, (like_emps(600),), 200)


def silent(line):
    pass


def test_ways_take_turns_after_a_call_that_is_not_timed(tmp_path):
    calls = tmp_path / "calls"

    def way(name):
        def run():
            with calls.open("a") as file:
                file.write(name)
            return name.upper()

        return run

    found = contest([Way("a", way("a")), Way("b", way("b")), Way("c", way("c"), slow=True)], 2, silent)
    assert calls.read_text() == "ab" + "abc" + "ab"
    assert [(one.name, len(one.seconds), one.found) for one in found] == [
        ("a", 2, "A"),
        ("b", 2, "B"),
        ("c", 1, "C"),
    ]
    assert all(one.memory > 1 for one in found)


def test_a_way_that_fails_is_named():
    with pytest.raises(RuntimeError, match="broken: division by zero"):
        contest([Way("broken", lambda: 1 / 0)], 1, silent)


def test_every_way_ends_at_the_same_optimum(short):
    """Ours, a plain least-squares fit and the thesis' transcription, on 0.6 s of a simulated EMPS."""
    task = short.task()
    ours, theirs = short.ours(), [short.alone(), by_numba(task), by_every_sample(task)]
    for one in theirs:
        assert task.rmse(one) == pytest.approx(task.rmse(ours), rel=1e-5)
        np.testing.assert_allclose(one, ours, rtol=2e-3)


def test_a_library_that_is_not_installed_is_a_row_of_its_own(short, monkeypatch):
    monkeypatch.setitem(fits.OPTIONAL, "jax-sysid", "no_such_module")
    monkeypatch.setattr(fits, "SLOW", ())
    monkeypatch.setattr(fits, "RIVALS", {"jax-sysid": by_jax_sysid})
    monkeypatch.setattr(fits, "contested", lambda horizon: short)
    rows = list(fits.beside(1, silent, True))
    assert [(row.way, row.reached) for row in rows if OURS not in row.way] == [
        ("jax-sysid", "not installed")
    ] * 4


def test_growth_is_told_in_seconds_a_sample():
    rows = [
        Row("growing", "few", OURS, (1.0,), "", "simulated", details={"samples": 10.0}),
        Row("growing", "many", OURS, (30.0,), "", "simulated", details={"samples": 200.0}),
    ]
    told = "seconds a sample over the first row's"
    assert [row.details[told] for row in fits._beside_first(rows)] == pytest.approx([1.0, 1.5])


def test_the_page_holds_every_way_against_ours(tmp_path):
    row = Row(BESIDE, "EMPS", OURS, (1.0, 2.0, 3.0), "RMSE 1 mm", "measured", 200.0)
    other = replace(row, way="another", seconds=(8.0,))
    said = write_report([row, other], tmp_path)
    assert "another: 8 s, 4 times ours" in said
    stored = json.loads((tmp_path / "speed.json").read_text())
    assert [one["median"] for one in stored["rows"]] == [2.0, 8.0]
    assert stored["machine"]["cores"] >= 1
    assert "measured" in (tmp_path / "index.md").read_text()
