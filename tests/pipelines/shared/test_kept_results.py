"""What was computed before an interruption is not computed again; what is not ours, or old, is not taken."""

from __future__ import annotations

import os
import time

import pytest

from hybridid import private
from hybridid.trace.mapper import serial
from pipelines.shared.kept_results import CLOCK, DAYS, _name_of, kept_results
from pipelines.shared.pool import mapper_of


@pytest.fixture(autouse=True)
def home(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    private.cache_folder.cache_clear()
    yield tmp_path / "hybridid" / "results"
    private.cache_folder.cache_clear()


class Squares:
    """Squares of numbers in two calls of a mapper, interrupted before the number ``last``."""

    def __init__(self) -> None:
        self.computed: list[int] = []
        self.said: list[str] = []

    def square(self, number: int) -> int:
        if number == self.last:
            raise KeyboardInterrupt
        self.computed.append(number)
        return number**2

    def __call__(self, last: int, key: str = "key", anew: bool = False) -> list[int]:
        self.last = last
        with kept_results(key, anew, self.said.append) as keep:
            mapper = keep(serial)
            low = list(mapper(self.square, [(k,) for k in range(3)]))
            return low + list(mapper(self.square, [(k,) for k in range(3, 6)]))


@pytest.fixture
def interrupted():
    squares = Squares()
    with pytest.raises(KeyboardInterrupt):
        squares(4)
    assert squares.computed == [0, 1, 2, 3]
    squares.computed.clear()
    return squares


def test_the_time_before_the_interruption_is_told(home):
    def run(seconds: float) -> None:
        with kept_results("key", False, print) as keep:
            told.append(keep.before)
            time.sleep(seconds)
            if len(told) < 3:
                raise KeyboardInterrupt

    told: list[float] = []
    for seconds in (0.1, 0.05):
        with pytest.raises(KeyboardInterrupt):
            run(seconds)
    run(0.0)
    assert told[0] == 0.0
    assert 0.1 <= told[1] <= told[2] - 0.05
    run(0.0)
    assert told[3] == 0.0


def test_a_clock_that_nobody_can_read_is_no_time(home):
    with pytest.raises(KeyboardInterrupt), kept_results("key", False, print) as keep:
        raise KeyboardInterrupt
    (keep.folder / CLOCK).write_text("later")
    with kept_results("key", False, print) as keep:
        assert keep.before == 0.0


def test_it_goes_on_where_it_was_interrupted(interrupted):
    assert interrupted(-1) == [0, 1, 4, 9, 16, 25]
    assert interrupted.computed == [4, 5]
    assert interrupted.said == ["goes on where it was interrupted: 4 results are kept"]


def test_another_one_with_that_key_takes_what_they_have_in_common(interrupted):
    """Whatever the order of their calls."""
    interrupted(-1)
    interrupted.computed.clear()
    with kept_results("key", False, interrupted.said.append) as keep:
        assert list(keep(serial)(interrupted.square, [(k,) for k in (7, 5, 0)])) == [49, 25, 0]
    assert interrupted.computed == [7]
    assert interrupted.said[-1] == "6 results are kept: none is computed again"


@pytest.mark.parametrize("changed", [{"key": "another"}, {"anew": True}])
def test_another_computation_takes_nothing(interrupted, changed):
    assert interrupted(-1, **changed) == [0, 1, 4, 9, 16, 25]
    assert interrupted.computed == [0, 1, 2, 3, 4, 5]
    assert interrupted.said == []


def test_only_what_is_whole_and_ones_own_is_taken(interrupted, home):
    kept = [home / "key" / _name_of(interrupted.square, (k,)) for k in range(3)]
    kept[0].write_bytes(kept[0].read_bytes()[:-1])
    kept[1].write_bytes(kept[2].read_bytes())
    kept[2].chmod(0o666)
    assert interrupted(-1) == [0, 1, 4, 9, 16, 25]
    assert interrupted.computed == [0, 1, 2, 4, 5]


def test_nothing_is_taken_from_a_folder_that_others_may_write_to(interrupted, home):
    (home / "key").chmod(0o777)
    assert interrupted(-1) == [0, 1, 4, 9, 16, 25]
    assert interrupted.computed == [0, 1, 2, 3, 4, 5]


def test_what_nobody_asked_for_in_a_week_is_removed(interrupted, home):
    begun = time.time() - 86400 * DAYS
    os.utime(home / "key", (begun + 60, begun + 60))
    with kept_results("other", False, print):
        assert (home / "key").exists()
    os.utime(home / "key", (begun - 60, begun - 60))
    with kept_results("other", False, print):
        assert not (home / "key").exists()


def test_what_was_not_used_for_longest_makes_room(interrupted, home, monkeypatch):
    with kept_results("newer", False, print) as keep:
        list(keep(serial)(divmod, [(7, 2)]))
    os.utime(home / "key", (time.time() - 60, time.time() - 60))
    size = sum(file.stat().st_size for file in (home / "newer").iterdir())
    monkeypatch.setattr("pipelines.shared.kept_results.MOST", size)
    with kept_results("other", False, print):
        assert (home / "newer").exists()
        assert not (home / "key").exists()


def test_a_full_disk_costs_the_copies_alone(interrupted, monkeypatch):
    def full(*given):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pipelines.shared.kept_results.write_bytes", full)
    assert interrupted(-1) == [0, 1, 4, 9, 16, 25]


def test_processes_keep_their_results_themselves(home):
    """The process that computes a result writes it: who waits for it may be killed before it comes."""
    with (
        pytest.raises(ZeroDivisionError),
        mapper_of(2) as mapper,
        kept_results("key", False, print) as keep,
    ):
        list(keep(mapper)(divmod, [(7, 2), (1, 0)]))
    assert sorted(file.name for file in (home / "key").iterdir()) == [
        CLOCK,
        _name_of(divmod, (7, 2)),
    ]
