"""Integrals and derivatives of recorded signals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import signal
from scipy.integrate import cumulative_trapezoid

from hybridid.records.record import Array, Record
from hybridid.signals.butterworth import butterworth_sections, check_order, forward_backward
from hybridid.signals.step import Role, Step, StepError, Target


@dataclass(frozen=True)
class Integrate(Step):
    """``y(t) = initial + ∫ x dt`` by the trapezoidal rule, without the drift of a sensor's offset.

    ``drift`` says what is removed: ``none`` nothing; ``mean`` the mean of x before integration (an
    offset); ``linear`` the least-squares line from y (an offset and an unknown initial value);
    ``highpass`` frequencies below ``cutoff`` [Hz] from y, by a zero-phase Butterworth of ``order``
    (an offset that varies slowly).

    The result is the signal ``name`` in ``unit``, placed by ``role`` and ``demote``.
    """

    signal: str
    name: str
    unit: str
    drift: Literal["none", "mean", "linear", "highpass"] = "none"
    cutoff: float | None = None
    order: int = 2
    initial: float = 0.0
    role: Role = "output"
    demote: bool = False

    def __post_init__(self) -> None:
        check_order(self.order)
        if (self.drift == "highpass") != (self.cutoff is not None):
            raise StepError(
                f"drift is {self.drift}, cutoff {self.cutoff}: highpass needs a cutoff, others have none"
            )
        if self.cutoff is not None and self.cutoff <= 0:
            raise StepError(f"cutoff is {self.cutoff:g} Hz, it must be positive")
        if self.initial and self.drift in ("linear", "highpass"):
            raise StepError(
                f"initial is {self.initial:g}, but drift: {self.drift} takes out any initial value"
            )

    @property
    def touched(self) -> tuple[str, ...]:
        return (self.signal,)

    def apply(self, record: Record) -> Record:
        x = record.signal(self.signal)
        if self.drift == "mean":
            x = x - x.mean()
        y = self.initial + cumulative_trapezoid(x, dx=record.dt, initial=0)
        if self.drift == "linear":
            y = signal.detrend(y)
        if self.cutoff is not None:
            y = forward_backward(butterworth_sections(self.order, self.cutoff, "high", record), y)
        return Target(self.signal, self.name, self.unit, self.role, self.demote).placed(record, y)


@dataclass(frozen=True)
class Differentiate(Step):
    """``y_k = (x_{k+1} - x_{k-1}) / (2 dt)`` after a zero-phase Butterworth low-pass.

    With ``derivative`` 2, the difference is taken twice: y_k is then the second derivative.

    ``cutoff`` [Hz] limits the noise, which a derivative amplifies in proportion to frequency.
    """

    signal: str
    name: str
    unit: str
    cutoff: float
    order: int = 4
    derivative: Literal[1, 2] = 1
    role: Role = "output"
    demote: bool = False

    def __post_init__(self) -> None:
        check_order(self.order)
        if self.cutoff <= 0:
            raise StepError(f"cutoff is {self.cutoff:g} Hz, it must be positive")

    @property
    def touched(self) -> tuple[str, ...]:
        return (self.signal,)

    def apply(self, record: Record) -> Record:
        sections = butterworth_sections(self.order, self.cutoff, "low", record)
        y = forward_backward(sections, record.signal(self.signal))
        for _ in range(self.derivative):
            y = np.gradient(y, record.dt, edge_order=2)
        return Target(self.signal, self.name, self.unit, self.role, self.demote).placed(record, y)


@dataclass(frozen=True)
class SavitzkyGolay(Step):
    """The ``derivative``-th derivative of a polynomial fitted to ``window`` samples around each one.

    ``window`` is odd and longer than the degree ``polynomial``. ``derivative: 0`` smooths. Without
    ``name`` the result replaces the signal; a derivative needs its ``unit``.

    Source: Savitzky, Golay (1964), Analytical Chemistry 36(8).
    """

    signal: str
    window: int
    polynomial: int = 3
    derivative: int = 0
    name: str | None = None
    unit: str | None = None
    role: Role = "output"
    demote: bool = False

    def __post_init__(self) -> None:
        if not 0 <= self.derivative <= self.polynomial < self.window or self.window % 2 == 0:
            raise StepError(
                f"derivative {self.derivative}, polynomial {self.polynomial}, window {self.window}: "
                "needed are 0 <= derivative <= polynomial < window, and an odd window"
            )
        if self.derivative and self.unit is None:
            raise StepError("a derivative has another unit than its signal; give unit")

    @property
    def touched(self) -> tuple[str, ...]:
        return (self.signal,)

    def apply(self, record: Record) -> Record:
        if self.window > record.n:
            raise StepError(f"window is {self.window}, record {record.name} has only {record.n} samples")
        values: Array = signal.savgol_filter(
            record.signal(self.signal), self.window, self.polynomial, self.derivative, delta=record.dt
        )
        own = next(c.unit for c in record.channels if c.name == self.signal)
        unit = own if self.unit is None else self.unit
        target = Target(self.signal, self.name or self.signal, unit, self.role, self.demote)
        return target.placed(record, values)
