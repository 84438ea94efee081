"""Records cut into horizons: where they lie, what is padded, what is left out."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.records.record import Channel, Record
from hybridid.simulation.recent import Recent
from hybridid.simulation.windows import cut


def record(n: int, dt: float = 0.01, hold: str = "zoh", name: str = "made", start: float = 0.0) -> Record:
    time = start + np.arange(n) * dt
    count = np.arange(n, dtype=float)
    return Record(
        name=name,
        time=time,
        inputs=np.stack([count, -count], axis=1),
        outputs=(10 * count)[:, None],
        input_channels=(Channel("a", "V", hold), Channel("b", "V")),
        output_channels=(Channel("y", "m"),),
    )


def test_a_whole_record_is_one_horizon():
    windows = cut([record(123)], None, 1)
    assert windows.origin == ((0, 0, 123),)
    assert windows.samples == 123
    assert windows.used[0, :123].all()
    assert not windows.used[0, 123:].any()
    np.testing.assert_array_equal(windows.outputs[0, :123, 0], 10.0 * np.arange(123))


def test_horizons_follow_each_other_and_the_last_is_padded():
    windows = cut([record(100)], 30, 1)
    assert windows.origin == ((0, 0, 30), (0, 30, 60), (0, 60, 90), (0, 90, 100))
    np.testing.assert_array_equal(windows.used.sum(axis=1), [30, 30, 30, 10])
    np.testing.assert_array_equal(windows.inputs[3, :10, 0], np.arange(90, 100))
    np.testing.assert_array_equal(windows.outputs[3, 10:, 0], np.full(windows.length - 10, 990.0))
    assert windows.samples == 100


def test_a_last_horizon_that_is_too_short_to_say_anything_is_left_out():
    assert cut([record(105)], 50, 1).origin == ((0, 0, 50), (0, 50, 100))
    assert cut([record(110)], 50, 1).origin[-1] == (0, 100, 110)


def test_no_horizon_reaches_into_the_next_record():
    windows = cut([record(70), record(45, name="other", start=5.0)], 40, 1)
    assert windows.origin == ((0, 0, 40), (0, 40, 70), (1, 0, 40))
    np.testing.assert_allclose(windows.time[2, :2], [5.0, 5.01])
    short = cut([record(70), record(12)], 40, 1)
    assert short.origin[-1] == (1, 0, 12), "a record shorter than the horizon counts whole"


def test_a_horizon_longer_than_the_records_is_the_records():
    assert cut([record(70), record(45)], 1000, 1).origin == ((0, 0, 70), (1, 0, 45))


def test_long_horizons_are_simulated_in_chunks_that_divide_them():
    windows = cut([record(5001)], None, 1)
    assert windows.length % windows.chunk == 0
    assert windows.chunk < windows.length
    assert windows.samples == 5001


def test_records_of_different_sampling_times_are_refused():
    with pytest.raises(ValueError, match=r"made and slow differ in sampling time \(0.01 s, 0.02 s\)"):
        cut([record(50), record(50, dt=0.02, name="slow")], None, 1)


def test_rounded_stamps_of_two_parts_of_a_recording_are_of_one_step():
    """Of 1.0237 s, rounded to 0.01 s: each part has a mean step of its own, a tenth of a per cent apart."""
    stamps = np.round(1.0237 * np.arange(312), 2)
    parts = [stamps[:218], stamps[218:]]
    steps = [(part[-1] - part[0]) / (len(part) - 1) for part in parts]
    assert abs(steps[0] - steps[1]) > 1e-5
    first, second = (record(len(t), dt=dt, name=f"{dt}") for t, dt in zip(parts, steps, strict=True))
    assert cut([first, second], None, 1).count == 2
    with pytest.raises(ValueError, match="differ in sampling time"):
        cut([record(2000, dt=1.0237), record(2000, dt=1.0240)], None, 1)


def test_a_horizon_of_one_sample_is_refused():
    with pytest.raises(ValueError, match="at least 2"):
        cut([record(50)], 1, 1)


def test_a_held_record_beside_one_that_is_not_stays_held():
    windows = cut([record(50, hold="foh"), record(50, name="held")], None, 2)
    assert not windows.held
    stages = windows.stages.reshape(2, windows.length, 5, 2)
    for stage in range(5):
        np.testing.assert_array_equal(stages[1, :50, stage, 0], np.arange(50))
        np.testing.assert_allclose(stages[0, :49, stage, 0], np.arange(49) + stage / 4)
        np.testing.assert_array_equal(stages[0, :50, stage, 1], -np.arange(50))


def test_horizons_can_be_chosen_and_shortened():
    windows = cut([record(100)], 25, 1).select([2, 0]).without_ends(5)
    assert windows.origin == ((0, 50, 75), (0, 0, 25))
    assert windows.samples == 40
    np.testing.assert_array_equal(windows.inputs[0, :25, 0], np.arange(50, 75))


@pytest.mark.parametrize("hold", ["zoh", "foh", "bandlimited"])
def test_of_many_horizons_some_are_kept_evenly_chosen(hold):
    records = [record(1050, hold=hold), record(20, hold="foh")]
    every, some = cut(records, 50, 3), cut(records, 50, 3, 4)
    chosen = [0, 7, 14, 21]
    assert some.origin == tuple(every.origin[k] for k in chosen)
    for name in ("time", "stages", "inputs", "outputs"):
        np.testing.assert_array_equal(getattr(some, name)[:, :50], getattr(every, name)[chosen, :50])


def test_no_more_horizons_are_kept_than_there_are():
    assert cut([record(100)], 50, 1, 50).count == 2


def test_horizons_that_were_cut_are_kept_for_the_next_who_asks():
    one = record(400)
    windows = cut([one], 50, 2)
    assert cut([one], 50, 2) is windows
    assert cut([one], 50, 3) is not windows
    assert cut([record(400)], 50, 2) is not windows, "another record, though it looks alike"


def test_what_was_asked_for_longest_ago_is_forgotten_first():
    made = []

    def of(name, size):
        return kept.get(name, lambda: made.append(name) or np.zeros(size // 8))

    kept = Recent(100 * 8)
    for name in ("a", "b", "a", "c", "a", "b"):
        of(name, 40 * 8)
    assert made == ["a", "b", "c", "b"], "a was asked for in between"
    of("large", 101 * 8)
    of("large", 101 * 8)
    assert made[-2:] == ["large", "large"], "it has no room"
    assert len(made) == 6
    of("b", 40 * 8)
    assert len(made) == 6
