"""The noise floor is a floor: neither motion nor jerks raise it, and quantisation is seen."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy.signal import welch

from hybridid.records.mapping import read_record, record_map
from hybridid.records.record import Channel, Record
from hybridid.records.sensor_noise import _density, noise_level, rounding
from hybridid.records.store import load_record, save_record
from hybridid.signals.butterworth import Butterworth

TIME = np.arange(4000) * 1e-3
MOTION = 0.1 * np.sin(2 * np.pi * 0.7 * TIME)


def record_of(samples):
    one = (Channel("force", "N"),)
    return Record("made", TIME, np.sin(TIME)[:, None], samples[:, None], one, (Channel("position", "m"),))


@pytest.mark.parametrize("std", [1e-7, 1e-5, 1e-3])
def test_white_noise_on_a_motion(std, noise):
    (found,) = noise_level(record_of(MOTION + noise(len(TIME), std, seed=3)))
    assert found == pytest.approx(std, rel=0.05)


@pytest.mark.parametrize("zero", [0.0, np.pi / 2])
@pytest.mark.parametrize("step", [1e-7, 1e-5, 1e-3])
def test_quantisation(step, zero):
    """Wherever the sensor's zero lies."""
    record = record_of(zero + step * np.round(MOTION / step))
    assert rounding(record) == pytest.approx([step / np.sqrt(12)])
    (found,) = noise_level(record)
    # rounding errors are not Gaussian: the local estimate may exceed the grid's own by a fifth
    assert found == pytest.approx(step / np.sqrt(12), rel=0.25)


def test_counts_of_an_encoder_that_a_file_rounds_to_some_digits():
    """16384 a turn, in rad to eight decimals: no level is a multiple of the first step."""
    step = 2 * np.pi / 16384
    turned = np.round(30 * (1 - np.cos(TIME)) / step) * step
    assert rounding(record_of(np.round(turned, 8))) == pytest.approx([step / np.sqrt(12)], rel=1e-3)


def test_resampling_hides_no_rounding(tmp_path):
    """The counts of an encoder at uneven stamps: between two of them the line is on no grid any more."""
    step, stamps = 0.01, TIME[:400] + np.where(np.arange(400) % 3 == 1, 4e-4, 0.0)
    counts = np.round(np.sin(9 * stamps) / step)
    pd.DataFrame({"t": stamps, "y": counts}).to_csv(tmp_path / "run.csv", index=False)
    plan = {
        "files": str(tmp_path / "run.csv"),
        "time": {"column": "t"},
        "outputs": {"y": {"unit": "rad", "column": "y", "scale": step}},
        "resample": 0.001,
    }
    record = read_record("counted", record_map(plan), [])
    error = np.std(record.output("y") - np.sin(9 * record.time))
    assert rounding(record) == pytest.approx([np.sqrt(2 / 3) * step / np.sqrt(12)])
    assert rounding(record) == pytest.approx([error], rel=0.25)
    filtered = Butterworth(("y",), 20.0).apply(record)
    assert rounding(filtered) == [0.0], "a filter takes a part of it, which nobody knows"
    assert load_record(save_record(record, tmp_path / "kept.parquet")).output_channels[0].rounding > 0


def test_a_jerk_does_not_raise_the_floor(noise):
    jerky = MOTION + np.cumsum(np.where(np.arange(len(TIME)) % 500 == 250, 1e-3, 0.0))
    (found,) = noise_level(record_of(jerky + noise(len(TIME), 1e-5, seed=4)))
    assert found == pytest.approx(1e-5, rel=0.1)


def test_motion_fast_beside_the_samples_is_no_noise(noise):
    fast = 0.05 * np.sin(2 * np.pi * 115.0 * TIME) + 0.03 * np.sin(2 * np.pi * 60.0 * TIME)
    (found,) = noise_level(record_of(fast + noise(len(TIME), 1e-4, seed=5)))
    assert found == pytest.approx(1e-4, rel=0.1)


def test_a_handful_of_samples_has_a_noise_too(noise):
    """Third differences take out what moves slowly; of so few samples the level is uncertain."""
    levels = []
    for seed in range(200):
        y = 0.3 * np.exp(-np.arange(25) / 30) + noise(25, 1e-3, seed=seed)
        given = (np.arange(25.0), np.zeros((25, 1)), y[:, None])
        one = Record("made", *given, (Channel("force", "N"),), (Channel("level", "m"),))
        levels.append(noise_level(one)[0])
    assert np.median(levels) == pytest.approx(1e-3, rel=0.1)


@pytest.mark.parametrize(("samples", "length"), [(1000, 256), (999, 255), (300, 75)])
def test_the_periodogram_is_welchs(samples, length):
    y = np.cumsum(np.random.default_rng(5).normal(size=samples))
    theirs = welch(y, nperseg=length)[1][1:-1]
    np.testing.assert_allclose(_density(y, length)[1:-1], theirs, rtol=1e-12)
