"""A record refuses what cannot be used, says where, and lets sound recordings pass."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest

from hybridid.records.checks import MINIMUM_SAMPLES
from hybridid.records.record import Channel, RecordError

N = 200


def test_a_sound_record_passes_without_a_word(make_record):
    record = make_record()
    assert record.warnings == ()
    assert record.n == N
    assert record.dt == pytest.approx(1e-3, rel=1e-12)
    assert record.provenance == "measured"


def test_arrays_are_copied_and_cannot_be_written(make_record):
    time = np.arange(N) * 1e-3
    record = make_record(time=time)
    time[0] = -1.0
    assert record.time[0] == 0.0
    for array in (record.time, record.inputs, record.outputs, record.auxiliary):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0
    with pytest.raises(FrozenInstanceError):
        record.name = "other"


def test_a_number_that_no_machine_gives_is_refused(make_record):
    outputs = np.array(make_record().outputs)
    outputs[33, 0] = -1e300
    with pytest.raises(RecordError, match=r"is -1e\+300 at sample 33, no quantity of a machine"):
        make_record(outputs=outputs)


@pytest.mark.parametrize("dt", [1e-305, 1e300])
def test_an_impossible_sampling_time_is_refused(make_record, dt):
    said = "the sampling time is 1e-305 s" if dt < 1 else "time .* no quantity of a machine"
    with pytest.raises(RecordError, match=said):
        make_record(time=np.arange(N) * dt)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(
    ("part", "column", "said"),
    [
        ("inputs", 0, "input 'force' [N]"),
        ("inputs", 1, "input 'road' [m]"),
        ("outputs", 1, "output 'angle' [rad]"),
        ("auxiliary", 0, "auxiliary 'reference' [m]"),
    ],
)
def test_the_first_missing_value_is_named(make_record, part, column, said, value):
    array = np.array(getattr(make_record(), part))
    array[[17, 90], column] = value
    with pytest.raises(RecordError) as caught:
        make_record(**{part: array})
    message = str(caught.value)
    assert said in message
    assert "sample 17 (t = 0.017 s)" in message
    assert "2 of 200" in message
    assert "\n" not in message


def test_a_missing_time_stamp_is_named(make_record):
    time = np.arange(N) * 1e-3
    time[33] = np.nan
    with pytest.raises(RecordError, match=r"time \[s\] is missing \(NaN\) at sample 33"):
        make_record(time=time)


@pytest.mark.parametrize("seed", range(20))
def test_one_displaced_stamp_is_found_where_it_is(make_record, seed):
    """Wherever a stamp is late, repeated or before its predecessor, the message names that step."""
    rng = np.random.default_rng(seed)
    k = int(rng.integers(1, N - 1))
    time = np.arange(N) * 1e-3
    for shift, said in ((0.3e-3, "uneven"), (-1e-3, "repeats"), (-1.4e-3, "runs backward")):
        moved = time.copy()
        moved[k] += shift
        with pytest.raises(RecordError, match=said) as caught:
            make_record(time=moved)
        assert f"sample {k - 1}" in str(caught.value) or f"sample {k} " in str(caught.value)


def test_the_worst_of_several_uneven_steps_is_named(make_record):
    time = np.arange(N) * 1e-3
    time[50:] += 0.1e-3
    time[120:] += 5e-3
    with pytest.raises(RecordError, match=r"step 0.006 s from sample 119 .*2 of 199 steps.*resample"):
        make_record(time=time)


def test_a_lost_block_of_samples_is_uneven(make_record):
    keep = np.r_[0:80, 95:N]
    sound = make_record()
    with pytest.raises(RecordError, match=r"step 0.016 s from sample 79 \(t = 0.079 s\)"):
        replace(
            sound,
            time=sound.time[keep],
            inputs=sound.inputs[keep],
            outputs=sound.outputs[keep],
            auxiliary=sound.auxiliary[keep],
        )


def test_a_clock_that_drifts_slowly_is_found(make_record):
    """No step is off by a percent, yet the stamps stray by samples."""
    n = 4000
    steps = 1e-3 * (1 + 0.008 * np.linspace(-1, 1, n - 1))
    time = np.concatenate([[0.0], np.cumsum(steps)])
    with pytest.raises(RecordError, match=r"drifts .* samples away from an even grid"):
        make_record(n=n, time=time)


@pytest.mark.parametrize("seed", range(5))
def test_jitter_far_below_a_sample_passes(make_record, seed):
    """EMPS: stamps stray by 3e-8 s at 1e-3 s. Also stamps kept in single precision."""
    jitter = np.random.default_rng(seed).uniform(-3e-8, 3e-8, N)
    assert make_record(time=np.arange(N) * 1e-3 + jitter).warnings == ()
    assert make_record(n=25000, time=(np.arange(25000) * 1e-3).astype(np.float32)).warnings == ()


def test_too_short_says_how_long_it_must_be(make_record):
    assert make_record(n=MINIMUM_SAMPLES).n == MINIMUM_SAMPLES
    with pytest.raises(
        RecordError, match=f"{MINIMUM_SAMPLES - 1} samples are too few, at least {MINIMUM_SAMPLES}"
    ):
        make_record(n=MINIMUM_SAMPLES - 1)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"inputs": np.zeros((N - 1, 2))}, "lengths differ: time has 200 samples, inputs 199"),
        ({"outputs": np.zeros((N, 3))}, r"outputs have shape \(200, 3\), expected \(n, 2\)"),
        ({"outputs": np.zeros(N)}, r"outputs have shape \(200,\)"),
        ({"auxiliary": None}, r"auxiliary signals have shape \(200, 0\), expected \(n, 1\)"),
        ({"time": np.zeros((N, 1))}, r"time has shape \(200, 1\)"),
        ({"outputs": np.zeros((N, 0)), "output_channels": ()}, "no output"),
        ({"auxiliary_channels": (Channel("force", "N"),)}, "'force' is taken twice"),
        ({"auxiliary_channels": (Channel("time", "s"),)}, "'time' is taken twice"),
        ({"inputs": [["a", "b"]] * N}, "inputs is not an array of numbers"),
    ],
)
def test_shapes_and_names_that_disagree_are_refused(make_record, changes, said):
    with pytest.raises(RecordError, match=said):
        make_record(**changes)


def test_a_record_without_inputs_is_one(make_record):
    """A pendulum let go."""
    free = make_record(inputs=np.empty((N, 0)), input_channels=())
    assert free.inputs.shape == (N, 0)


def test_an_unknown_hold_is_refused():
    with pytest.raises(RecordError, match="hold is 'cubic', allowed: zoh, foh, bandlimited"):
        Channel("force", "N", "cubic")


def test_a_constant_signal_is_worth_a_warning_an_auxiliary_one_is_not(make_record):
    inputs = np.array(make_record().inputs)
    inputs[:, 0] = 2.5
    record = make_record(inputs=inputs, auxiliary=np.zeros((N, 1)))
    (told,) = record.warnings
    assert told.startswith("record bench: input 'force' is constant (2.5 N); a delay, a lag, a dead zone")
    inputs[:, 0] = 0.0
    silent = make_record(inputs=inputs, auxiliary=np.zeros((N, 1)))
    assert silent.warnings == ("record bench: input 'force' is constant (0 N)",)


def test_signals_by_name(make_record):
    record = make_record()
    assert np.array_equal(record.output("angle"), record.outputs[:, 1])
    assert np.array_equal(record.input("road"), record.inputs[:, 1])
    assert np.array_equal(record.signal("force"), record.inputs[:, 0])
    assert np.array_equal(record.signal("reference"), record.auxiliary[:, 0])
    with pytest.raises(RecordError, match="unknown output 'positon': did you mean 'position'"):
        record.output("positon")
    with pytest.raises(RecordError, match="unknown input 'position'"):
        record.input("position")


def test_a_part_keeps_what_was_done_and_forgets_what_was_seen(make_record):
    """Resampled stays resampled; a part without the clipped stretch is not clipped."""
    wave = np.column_stack([np.clip(np.sin(np.arange(2000) / 50), -2, 0.8), np.arange(2000)])
    whole = make_record(n=2000, outputs=wave, warnings=("record bench: resampled",))
    assert whole.warnings[0] == "record bench: resampled"
    assert "looks clipped" in whole.warnings[1]
    assert whole.part(0, 45).warnings == ("record bench: resampled",)
    clipped = whole.part(0, 200, name="first")
    assert clipped.warnings[0] == "record bench: resampled"
    assert "record first: output 'position' looks clipped" in clipped.warnings[1]
    assert len(clipped.warnings) == 2


def test_a_part_is_those_samples(make_record):
    whole = make_record()
    part = whole.part(50, 120)
    assert part.n == 70
    for field in ("time", "inputs", "outputs", "auxiliary"):
        assert np.array_equal(getattr(part, field), getattr(whole, field)[50:120])
    assert (part.name, part.digest, part.input_channels) == (whole.name, whole.digest, whole.input_channels)


def test_copies_do_not_repeat_warnings(make_record):
    outputs = np.array(make_record().outputs)
    outputs[:, 0] = 1.0
    record = make_record(outputs=outputs)
    assert replace(replace(record, source="a"), source="b").warnings == record.warnings
