"""Clipped signals are noticed; rests, levels, staircases and coarse encoders are not taken for them."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.records.clipping import clipped_runs

N = 20000
T = np.arange(N) * 1e-3  # s
SINE = np.sin(np.pi * T)


def quantised(x: np.ndarray, step: float) -> np.ndarray:
    return np.round(x / step) * step


def noise(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=N)


def multisine(seed: int) -> np.ndarray:
    phases = np.random.default_rng(seed).uniform(0, 2 * np.pi, 29)
    return np.sum([np.sin(2 * np.pi * (k + 1) * T + p) for k, p in enumerate(phases)], axis=0)


def back_and_forth() -> np.ndarray:
    """A carriage that goes out, dwells at the far end, comes back and dwells, three times (bang-bang)."""
    out = np.r_[np.zeros(500), np.ones(400), np.zeros(300), -np.ones(400), np.zeros(2000)]
    acceleration = np.tile(np.r_[out, -out], 3)
    return np.cumsum(np.cumsum(acceleration)) * 1e-6


def levels(values: list[float], length: int) -> np.ndarray:
    return np.repeat(np.random.default_rng(1).choice(values, N // length), length)


CLIPPED = {
    "sine at 0.9": np.clip(SINE, -0.9, 0.9),
    "sine at 0.99": np.clip(SINE, -0.99, 0.99),
    "sine, top only": np.minimum(SINE, 0.5),
    "8-bit sine": np.clip(quantised(SINE, 1 / 127), -1, 0.8),
    "noisy drive command": np.clip(3 * SINE + 0.1 * noise(), -1, 1),
    "barely noisy": np.clip(SINE + 0.01 * noise(), -0.9, 0.9),
    "multisine": np.clip(multisine(0), -8, 8),
    "coarse multisine": np.clip(quantised(multisine(1), 0.01), -8, 8),
}

WHOLE = {
    "sine": SINE,
    "8-bit sine": quantised(SINE, 1 / 127),
    "4-bit sine": quantised(SINE, 1 / 7),
    "three-level sine": quantised(SINE, 0.5),
    "slow 8-bit sine": quantised(np.sin(2 * np.pi * T / 20), 1 / 127),
    "slow coarse sine": quantised(np.sin(2 * np.pi * T / 20), 1 / 10),
    "fast coarse sine": quantised(np.sin(10 * np.pi * T), 1 / 20),
    "encoder": quantised(0.25 * SINE, 5e-8),
    "dwell": back_and_forth(),
    "dwell, fine encoder": quantised(back_and_forth() + 0.1, 5e-8),
    "dwell, 1 mm encoder": quantised(back_and_forth(), 1e-3),
    "dwell, 1 cm encoder": quantised(back_and_forth(), 1e-2),
    "square": np.sign(SINE + 1e-9),
    "random binary": levels([-1.0, 1.0], 100),
    "three levels": levels([-1.0, 0.0, 1.0], 100),
    "staircase": np.repeat(np.random.default_rng(2).normal(size=200), 100),
    "pulses": (SINE > 0.9) * 5.0,
    "half sine, resting at 0": np.maximum(SINE, 0),
    "half sine, resting at an offset": np.maximum(SINE, 0) + 0.3,
    "noise": noise(),
    "coarse noise": quantised(noise(), 0.1),
    "multisine": multisine(3),
    "coarse multisine": quantised(multisine(4), 1.0),
    "constant": np.full(N, 3.0),
}


@pytest.mark.parametrize("name", CLIPPED)
@pytest.mark.parametrize(("gain", "offset"), [(1.0, 0.0), (-2e-3, 0.0), (1.0, 7.0)])
def test_a_clipped_signal_is_noticed_at_its_limit(name, gain, offset):
    values = gain * CLIPPED[name] + offset
    runs = clipped_runs(values)
    assert runs
    for start, stop in runs:
        assert np.ptp(values[start:stop]) == 0
        assert values[start] in (values.min(), values.max())
        assert values[start - 1] != values[start]
        assert values[stop] != values[start]


@pytest.mark.parametrize("name", WHOLE)
@pytest.mark.parametrize("gain", [1.0, -35.15])
def test_no_false_alarm(name, gain):
    assert clipped_runs(gain * WHOLE[name]) == []


def test_a_record_says_so(make_record):
    n = 2000
    outputs = np.column_stack([np.clip(np.sin(np.arange(n) / 50), -1, 0.8), noise()[:n]])
    (warning,) = make_record(n=n, outputs=outputs).warnings
    assert "output 'position' looks clipped: " in warning
    assert "0.8 m" in warning
    assert "t = 0.047 s" in warning
