"""The noise of a record's outputs, below which no model can explain anything, and of its inputs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs, savgol_filter
from scipy.stats import chi2

from hybridid.records.masked import Counts, pieces
from hybridid.records.record import Record

Array = NDArray[np.float64]
HALF_WIDTH, ORDER = 4, 3
SEGMENT, QUIETEST = 256, 0.1
AGREE = 4.0
"""Factor within which the two looks at white noise agree; else one of them sees motion, or a filter. An
encoder's counts divided by the sample time, noise that is quiet at low frequencies, make a factor of 3."""
CLEAN = 0.1
"""Noise of a measured input over its own standard deviation, at most. What is more is taken for the input: a
white excitation is no noise."""


class SensorNoise(NamedTuple):
    """Standard deviation ``level`` of an output's sample noise, in its unit; ``told``: the record tells it.

    A record does not tell it where the motion is as fast as the samples, or where a filter has taken the
    noise at the high frequencies: what is left there says nothing of the noise at the others.
    """

    level: float
    told: bool


def sensor_noise(record: Record) -> tuple[SensorNoise, ...]:
    """The noise of each output: at least the quantisation, and the larger of two looks at white noise."""
    hidden = [channel.rounding for channel in record.output_channels]
    return tuple(_told(y, least) for y, least in zip(_counted(record), hidden, strict=True))


def _told(y: Array, least: float) -> SensorNoise:
    """``least`` is what resampling has hidden of the rounding: a bound, which does not tell the level."""
    step, local, quietest = rounding_of(y), _local(y), _quietest(y)
    agree = 0 < max(local, quietest) <= AGREE * min(local, quietest)
    level = max(step, local, quietest) if agree else max(step, min(local, quietest))
    return SensorNoise(max(float(level), least), bool(agree or (step > 0 and step >= max(local, quietest))))


def noise_level(record: Record) -> Array:
    """Standard deviation of each output's sample noise, shape (n_y,).

    The larger of the quantisation step over sqrt(12) and of what looks like white noise: the lesser
    of what a local cubic leaves and of what the quietest frequencies show. The cubic takes fast
    motion for noise, the spectrum what leaks from strong motion; neither takes noise for motion.
    """
    shown = np.array([min(_local(y), _quietest(y)) for y in _counted(record)])
    return np.maximum(rounding(record), shown)


def input_noise(record: Record) -> Array:
    """Standard deviation (n_u,) of the white noise that each input has at most, in its unit; 0 where what
    looks like noise is more than ``CLEAN`` of the input itself."""
    shown = np.array([min(_local(u), _quietest(u)) for u in record.inputs.T])
    return np.where(shown <= CLEAN * np.std(record.inputs, axis=0), shown, 0.0)


def rounding(record: Record) -> Array:
    """Standard deviation (n_y,) of the rounding of each output to a grid: that which the samples show, or
    which its channel tells; else 0."""
    shown = [rounding_of(y) for y in _counted(record)]
    return np.maximum(shown, [channel.rounding for channel in record.output_channels])


def rounding_of(y: Array) -> float:
    """Standard deviation of the rounding of the samples ``y`` (n,) to a grid, its step over sqrt(12); 0 where
    they lie on none."""
    return float(_quantisation(y) / np.sqrt(12))


def _counted(record: Record) -> list[Array]:
    """Each output (m,) at the samples that count, each stretch shifted to where the one before ended."""
    if not record.partly:
        return list(record.outputs.T)
    return [_joined(y, counts) for y, counts in zip(record.outputs.T, record.cells.T, strict=True)]


def _joined(y: Array, counts: Counts) -> Array:
    found: list[Array] = []
    for first, end in pieces(counts):
        piece = y[first:end]
        found.append(piece - piece[0] + found[-1][-1] if found else piece)
    return np.concatenate(found)


def _quantisation(y: Array) -> float:
    """Smallest difference between levels, when the levels lie on a grid, wherever that begins; else 0."""
    levels = np.unique(y)
    steps = np.unique(np.diff(levels))
    steps = steps[steps > 1e-12 * np.ptp(y)]
    if not len(steps):
        return 0.0
    step = _refined(float(steps[0]), levels - levels[0])
    steps_off = (y - y[0]) / step
    on_grid = np.abs(steps_off - np.round(steps_off)) < 0.05
    return step if on_grid.mean() > 0.99 and np.ptp(y) / step < 1e9 else 0.0


def _refined(step: float, levels: Array) -> float:
    """The step of a grid over all ``levels`` (m,), the first one 0.

    A file holds each level rounded to some digits. The difference of two neighbours knows the step to these,
    that of two levels n steps apart n times as well. So it is fitted to twice as many steps again and again.
    """
    reach = 2.0
    while reach * step < 2 * levels[-1]:
        within = levels[levels <= reach * step]
        numbers = np.round(within / step)
        if numbers.any():
            step = float(numbers @ within / (numbers @ numbers))
        reach *= 2
    return step


def _local(y: Array) -> float:
    """What a local cubic over ``2 HALF_WIDTH + 1`` samples leaves, less what it absorbs of noise itself; in a
    short record, what third differences leave.

    The median makes it a floor: jerks in the motion do not raise it.
    """
    width = 2 * HALF_WIDTH + 1
    if len(y) < 3 * width:
        return float(np.median(np.abs(np.diff(y, 3))) / 0.6745 / np.sqrt(20)) if len(y) > 3 else 0.0
    rest = (y - savgol_filter(y, width, ORDER))[width:-width]
    kept = 1.0 - savgol_coeffs(width, ORDER)[HALF_WIDTH]
    # The median of |rest| is 0.6745 standard deviations of Gaussian noise.
    return float(np.median(np.abs(rest)) / 0.6745 / np.sqrt(kept))


def _quietest(y: Array) -> float:
    """White noise of the level that the quietest tenth of the frequencies shows (Welch's periodogram).

    A low quantile of a scattered estimate lies below what it scatters about: a chi-squared
    distribution with two degrees of freedom a segment says by how much.
    """
    length = min(SEGMENT, len(y) // 4)
    if length < 16:
        return np.inf
    density = _density(y, length)
    degrees = 2 * max(1.0, 1.9 * len(y) / length - 1.0)  # half overlapped
    level = np.quantile(density[2:-1], QUIETEST) / (chi2.ppf(QUIETEST, degrees) / degrees)
    return float(np.sqrt(level / 2))


def _density(y: Array, length: int) -> Array:
    """Welch's periodogram (length // 2 + 1,) at a sampling rate of 1, one-sided, of half overlapped segments
    of ``length`` samples under a Hann window, each less its mean: as ``scipy.signal.welch``, which takes
    segment after segment. The first and the last entry are twice as large there."""
    window = np.hanning(length + 1)[:-1]
    pieces = sliding_window_view(y, length)[:: length - length // 2]
    pieces = pieces - pieces.mean(axis=1, keepdims=True)
    power = np.abs(np.fft.rfft(pieces * window, axis=1)) ** 2
    density: Array = 2.0 * power.mean(axis=0) / (window @ window)
    return density
