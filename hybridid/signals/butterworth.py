"""Butterworth filtering, zero-phase or causal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from scipy import signal

from hybridid.records.record import Array, Record
from hybridid.signals.step import Step, StepError, in_place

Band = Literal["low", "high", "band"]
Sections: TypeAlias = Array  # (number of second-order sections, 6)

MAXIMUM_ORDER = 20
SETTLED = 1e-3  # of a transient; padding must last until it has decayed to this
HARDLY_SETTLED = 0.05  # of a transient; a record shorter than its decay to this cannot be filtered


@dataclass(frozen=True)
class Butterworth(Step):
    """``|H(f)|² = 1 / (1 + (f / cutoff)^(2 order))`` for ``low``; ``high`` and ``band`` accordingly.

    ``cutoff`` is in Hz, two values for ``band``. ``zero_phase`` runs the filter forward and backward:
    no lag, twice the order, and |H|² (6 dB instead of 3 dB) at the cutoff. Without it, the filter is
    causal and delays the signal. Both start in the steady state of the signal's first value (``low``).

    A filtered input keeps its hold. Filter inputs and outputs alike: then a linear plant maps the
    filtered input samples to the filtered output samples.

    Source: S. Butterworth (1930); second-order sections as in Oppenheim, Schafer,
    Discrete-Time Signal Processing, ch. 6.
    """

    signals: tuple[str, ...]
    cutoff: float | tuple[float, float]
    order: int = 4
    kind: Band = "low"
    zero_phase: bool = True

    def __post_init__(self) -> None:
        check_order(self.order)
        if (self.kind == "band") != isinstance(self.cutoff, tuple):
            raise StepError(f"cutoff {self.cutoff} does not suit {self.kind}: band needs two, the others one")
        edges = np.atleast_1d(self.cutoff)
        if not (edges[0] > 0 and np.all(np.diff(edges) > 0)):
            raise StepError(f"cutoff {self.cutoff} Hz must be positive, and rising if there are two")

    @property
    def touched(self) -> tuple[str, ...]:
        return self.signals

    @property
    def causal_filter(self) -> str:
        if self.zero_phase:
            return ""
        if isinstance(self.cutoff, tuple):
            return f"band-pass of order {self.order} at {self.cutoff[0]:g} to {self.cutoff[1]:g} Hz"
        lag = f", {1e3 * low_frequency_delay(self.order, self.cutoff):.3g} ms" if self.kind == "low" else ""
        return f"{self.kind}-pass of order {self.order} at {self.cutoff:g} Hz{lag}"

    def apply(self, record: Record) -> Record:
        sections = butterworth_sections(self.order, self.cutoff, self.kind, record)
        run = forward_backward if self.zero_phase else forward
        return in_place(record, self.signals, lambda x: run(sections, x))


def check_order(order: int) -> None:
    """Check a filter order.

    Raises:
        StepError: if ``order`` is not between 1 and ``MAXIMUM_ORDER``.
    """
    if not 1 <= order <= MAXIMUM_ORDER:
        raise StepError(f"order is {order}, allowed: 1 to {MAXIMUM_ORDER}")


def low_frequency_delay(order: int, cutoff: float) -> float:
    """``1 / (2π cutoff sin(π / (2 order)))``: the group delay [s] of a causal low-pass at 0 Hz."""
    return 1 / (2 * np.pi * cutoff * np.sin(np.pi / (2 * order)))


def butterworth_sections(
    order: int, cutoff: float | tuple[float, float], kind: Band, record: Record
) -> Sections:
    """The filter for the record's sampling time, as second-order sections (n_sections, 6).

    Raises:
        StepError: if a cutoff is not below half the sampling frequency.
    """
    highest, nyquist = float(np.max(cutoff)), 0.5 / record.dt
    if highest >= nyquist:
        raise StepError(
            f"cutoff is {highest:g} Hz, it must be below {nyquist:g} Hz, "
            f"the Nyquist frequency of record {record.name}"
        )
    return signal.butter(order, cutoff, kind, fs=1 / record.dt, output="sos")


def forward_backward(sections: Sections, x: Array) -> Array:
    """``H(1/z) H(z) x`` for x (n,): zero phase; both ends are padded by the settling time of the filter.

    Raises:
        StepError: if the signal is shorter than the filter's own transient.
    """
    if (transient := _settling(sections, HARDLY_SETTLED)) > len(x):
        raise StepError(
            f"the filter needs {transient} samples to settle, there are {len(x)}: raise the cutoff"
        )
    return signal.sosfiltfilt(sections, x, padlen=min(_settling(sections, SETTLED), len(x) - 1))


def forward(sections: Sections, x: Array) -> Array:
    """``H(z) x`` for x (n,), from the steady state of its first value."""
    return signal.sosfilt(sections, x, zi=signal.sosfilt_zi(sections) * x[0])[0]


def _settling(sections: Sections, rest: float) -> int:
    """Samples until the slowest pole's transient has decayed to ``rest`` of its beginning."""
    radius = max(float(np.abs(np.roots(section[3:])).max()) for section in sections)
    return int(np.ceil(np.log(rest) / np.log(radius)))
