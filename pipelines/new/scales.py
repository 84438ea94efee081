"""How large the signals of a recording are: the typical magnitudes at the head of a plant's file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from hybridid.records.record import Record
from pipelines.new.template import Scale
from pipelines.shared.errors import ConfigError

Array = NDArray[np.float64]
EXCEEDED = 5.0  # % of the time
POWER = 0.9999  # of a signal; what lies above is little, and mostly noise
_WINDOWS = (7, 51)
_SHARE = 0.005  # of the record: over that much a derivative is smoothed, within _WINDOWS samples


class StillError(ConfigError):
    """A ``signal`` never changes, so nothing tells how large it is."""

    def __init__(self, signal: str, kind: str) -> None:
        super().__init__(f"signal {signal} never changes: its {kind.replace('_', ' ')} is zero")
        self.signal = signal


def scales(wanted: Mapping[str, Scale], records: Sequence[Record]) -> dict[str, float]:
    """The number of each scale over all ``records``, to two digits.

    Raises:
        StillError: if one is zero, because its signal never changes.
    """
    return {name: _rounded(name, scale, records) for name, scale in wanted.items()}


def _rounded(name: str, scale: Scale, records: Sequence[Record]) -> float:
    found = max(_magnitude(scale, record) for record in records)
    if not found > 0:
        raise StillError(scale.of, scale.kind)
    return float(f"{found:.2g}")


def _magnitude(scale: Scale, record: Record) -> float:
    signal = record.signal(scale.of) - (record.signal(scale.less) if scale.less else 0.0)
    if scale.kind == "half_range":
        return float(np.ptp(signal)) / 2
    of = _derivative(signal, record.dt) if scale.kind == "speed" else signal
    return float(np.percentile(np.abs(of), 100 - EXCEEDED)) or float(np.max(np.abs(of)))


def cutoff(signal: Array, dt: float) -> float:
    """Five times the frequency in Hz below which nearly all power of a signal lies, at most a fifth of the
    sampling rate: a derivative above it would be noise."""
    from scipy.signal import periodogram

    frequency, power = periodogram(signal, 1 / dt, detrend="linear", window="hann")
    shares = np.cumsum(power) / np.sum(power)
    return float(f"{min(5 * frequency[np.searchsorted(shares, POWER)], 0.2 / dt):.2g}")


def _derivative(signal: Array, dt: float) -> Array:
    from scipy.signal import savgol_filter

    window = int(np.clip(_SHARE * len(signal), *_WINDOWS)) | 1
    return np.asarray(
        savgol_filter(signal, min(window, len(signal) - 1 + len(signal) % 2), 2, deriv=1, delta=dt)
    )
