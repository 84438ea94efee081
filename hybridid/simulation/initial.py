"""States of a model estimated from a record: smoothed outputs and their derivatives."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from hybridid.declarations import State
from hybridid.model import Model
from hybridid.records.masked import Counts
from hybridid.records.record import Record

Array = NDArray[np.float64]
HALF_WIDTH = 10
"""Samples on each side that the local polynomial uses."""
ORDER = 3
"""Degree of the local polynomial of the output: 3, so that the velocity is quadratic."""
SHARE = 0.99
"""Share of an output's power that counts as signal; the rest counts as noise."""
MARGIN = 2.0
"""The polynomial passes frequencies up to this multiple of the signal's highest frequency."""
FEW = 0.1
"""Share of the samples that show all outputs below which the others are taken, too."""
_KEPT: WeakKeyDictionary[Record, dict[tuple[str, int, int], Array]] = WeakKeyDictionary()


def smoothed_derivative(samples: Array, dt: float, derivative: int, half_width: int = HALF_WIDTH) -> Array:
    """Savitzky-Golay estimate of the ``derivative``-th time derivative, shape (n,).

    ``half_width`` is the largest number of samples on each side. A signal that oscillates within them
    gets fewer, because they would smooth it away.
    """
    n = len(samples)
    width = min(2 * min(half_width, widest_half_width(samples)) + 1, n - (n + 1) % 2)
    order = min(ORDER, width - 1)
    if derivative > order:
        return np.zeros(n)
    return savgol_filter(samples, width, order, deriv=derivative, delta=dt, mode="interp")


def widest_half_width(samples: Array) -> int:
    """Samples on each side that a cubic may span without smoothing the signal away.

    A Savitzky-Golay filter of degree N and half width M passes up to (N + 1) / (3.2 M - 4.6) of
    the Nyquist frequency. Source: Schafer (2011), IEEE Signal Processing Magazine 28(4), 111-117.
    """
    power = np.abs(np.fft.rfft(samples - samples.mean())) ** 2
    total = np.cumsum(power)
    if not total[-1] > 0:
        return len(samples)
    highest = MARGIN * max(int(np.searchsorted(total, SHARE * total[-1])), 1) / (len(power) - 1)
    return max(ORDER // 2 + 1, int(((ORDER + 1) / highest + 4.6) / 3.2))


def observed(model: Model) -> tuple[bool, ...]:
    """For each state, whether it is an output or a time derivative of one; (n_x,)."""
    return tuple(state.observed_by is not None for state in model.states)


def measured_states(model: Model, record: Record, half_width: int = HALF_WIDTH) -> Array:
    """States from the record, shape (n, n_x); zero for states that are not observed, or the input as which
    they begin: with the record, the part of it that was there before."""
    states = np.zeros((record.n, len(model.states)))
    for j, state in enumerate(model.states):
        if state.observed_by is not None:
            states[:, j] = output_derivative(record, state.observed_by, state.derivative, half_width)
        elif state.begins_as is not None:
            states[:, j] = record.input(state.begins_as)
            states[0, j] *= _share_before(model, state)
    return states


def _share_before(model: Model, state: State) -> float:
    """The share of an input's first sample that was there before the record, for a state that follows it."""
    shares = (p.guess for p in model.parameters if p.name == state.begins_by)
    return next(shares, 1.0)


def telling(record: Record) -> Counts:
    """Which samples (n,) show where the machine was: those that count with all outputs; where these are few,
    as of sensors of other rates, all that count."""
    return record.whole if record.whole.mean() >= FEW * record.counts.mean() else record.counts


def _filled(record: Record, output: str) -> Array:
    """An output (n,), with a straight line through the cells at which it was not measured."""
    samples = record.output(output)
    if record.absent is None:
        return samples
    seen = record.cells[:, [channel.name for channel in record.output_channels].index(output)]
    return np.where(seen, samples, np.interp(record.time, record.time[seen], samples[seen]))


def output_derivative(record: Record, output: str, derivative: int, half_width: int = HALF_WIDTH) -> Array:
    """``smoothed_derivative`` of an output, (n,), found once a record: each model tried asks for it."""
    kept, key = _KEPT.setdefault(record, {}), (output, derivative, half_width)
    if key not in kept:
        samples = _filled(record, output)
        found = smoothed_derivative(samples, record.dt, derivative, half_width)
        if record.masked:  # what does not count says nothing of the samples beside it
            for piece in (slice(*one) for one in record.pieces):
                found[piece] = smoothed_derivative(samples[piece], record.dt, derivative, half_width)
        kept[key] = found
        kept[key].flags.writeable = False
    return kept[key]
