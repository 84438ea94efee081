"""Cropping, means, offsets and scales."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.records.record import RecordError
from hybridid.signals.butterworth import Butterworth
from hybridid.signals.simple import Crop, Offset, RemoveMean, Scale
from hybridid.signals.step import StepError


@pytest.mark.parametrize("cut", [0.3, 0.7001, 1.2345, 1.9])
@pytest.mark.parametrize("dt", [1e-3, 1 / 610.35])
def test_parts_that_share_a_bound_make_the_whole(record_of, cut, dt):
    record = record_of(dt=dt)
    first, rest = Crop(stop=cut).apply(record), Crop(start=cut).apply(record)
    assert first.time[-1] < cut <= rest.time[0] + 1e-9
    assert np.array_equal(np.concatenate([first.time, rest.time]), record.time)
    assert np.array_equal(np.vstack([first.outputs, rest.outputs]), record.outputs)
    assert np.array_equal(np.vstack([first.auxiliary, rest.auxiliary]), record.auxiliary)


def test_a_bound_on_a_sample_is_not_lost_to_rounding(record_of):
    """0.1 + 0.2 is a hair above 0.3."""
    assert Crop(start=0.1 + 0.2).apply(record_of()).time[0] == pytest.approx(0.3)
    assert Crop(stop=0.1 + 0.2).apply(record_of()).n == 300


def test_crop_by_samples(record_of):
    record = record_of()
    part = Crop(samples=(100, 250)).apply(record)
    assert np.array_equal(part.time, record.time[100:250])


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({}, "give start and/or stop in seconds, or samples"),
        ({"start": 1.0, "samples": (0, 20)}, "give start and/or stop in seconds, or samples"),
        ({"start": 1.0, "stop": 1.0}, "start 1 s is not before stop 1 s"),
        ({"samples": (30, 20)}, "must be rising"),
        ({"start": 5.0}, "are not in record bench: it has 2000 samples, from 0 s to 1.999 s"),
        ({"samples": (0, 2001)}, "samples 0 to 2001 are not in record bench"),
    ],
)
def test_impossible_crops(record_of, values, said):
    with pytest.raises(StepError, match=said):
        Crop(**values).apply(record_of())


def test_a_crop_that_leaves_too_little(record_of):
    with pytest.raises(RecordError, match="4 samples are too few"):
        Crop(samples=(0, 4)).apply(record_of())


def test_remove_mean(record_of):
    record = record_of(y=lambda t: 3 + np.sin(50 * t) * (t > 0.5), u=lambda t: 1 + t)
    whole = RemoveMean(("position", "force")).apply(record)
    assert abs(whole.output("position").mean()) < 1e-12
    assert abs(whole.input("force").mean()) < 1e-12
    rest = RemoveMean(("position",), over=(0.0, 0.5)).apply(record)
    np.testing.assert_allclose(rest.output("position")[:500], 0.0, atol=1e-12)
    assert np.array_equal(rest.inputs, record.inputs)
    with pytest.raises(StepError, match="no sample of record bench lies from 7 s to 8 s"):
        RemoveMean(("position",), over=(7.0, 8.0)).apply(record)


def test_offset_and_scale(record_of):
    record = record_of()
    shifted = Offset(("position",), 0.5).apply(record)
    np.testing.assert_allclose(shifted.output("position"), record.output("position") + 0.5)
    scaled = Scale(("force",), -2.0, "mN").apply(record)
    np.testing.assert_allclose(scaled.input("force"), -2 * record.input("force"))
    assert [(c.unit, c.hold) for c in scaled.input_channels] == [("mN", "zoh")]
    assert Scale(("force",), 3.0).apply(record).input_channels == record.input_channels
    with pytest.raises(StepError, match="factor is 0"):
        Scale(("force",), 0.0)


@pytest.mark.parametrize(
    "step", [RemoveMean(()), Offset((), 1.0), Scale((), 2.0), Scale((), 2.0, unit="V"), Butterworth((), 5.0)]
)
def test_a_step_of_no_signal_is_refused(record_of, step):
    """It would leave every record as it was, without a word."""
    with pytest.raises(StepError, match=r"signals is \[\]: give at least one signal"):
        step.apply(record_of())
