"""Decimation: fewer samples, without aliasing."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import signal

from hybridid.records.masked import Cells, Levels, masked_of
from hybridid.records.record import Array, Hold, Record
from hybridid.signals.step import Step, StepError

PASS_BAND = 0.8  # of the new Nyquist frequency
ATTENUATION = 80.0  # dB beyond the new Nyquist frequency


@dataclass(frozen=True)
class Decimate(Step):
    """Every ``factor``-th sample of every signal; the filter depends on the signal's hold.

    Outputs, auxiliary signals and inputs that are ``foh`` or ``bandlimited`` pass a symmetric
    FIR low-pass first (Kaiser window, flat to 0.8 of the new Nyquist frequency, 80 dB down
    beyond it, no lag, gain 1 at 0 Hz). A held input (``zoh``) becomes its mean over each new
    sampling interval. The mean keeps the integral of the command, which is what moves the machine.
    ``anti_alias: false`` leaves out the low-pass; held inputs are averaged all the same.

    scipy's own ``decimate`` is not used: its Chebyshev filter scales a position by 0.989.

    Source: Oppenheim, Schafer, Discrete-Time Signal Processing, sections 4.6 and 7.5 (Kaiser).
    """

    factor: int
    anti_alias: bool = True

    def __post_init__(self) -> None:
        if self.factor < 2:
            raise StepError(f"factor is {self.factor}, it must be at least 2")

    def apply(self, record: Record) -> Record:
        kept = record.n // self.factor  # whole blocks only: a held input needs the mean of each
        reach = _length(self.factor)[0] // 2 if self.anti_alias else 0
        if reach >= record.n or kept < 1:
            raise StepError(
                f"record {record.name} has {record.n} samples, too few to decimate by {self.factor}: "
                f"its filter reaches {reach} to each side"
            )
        taps = _low_pass(self.factor) if self.anti_alias else np.ones(1)

        def thinned(values: Array, hold: Hold | None) -> Array:
            if hold == "zoh":
                return values[: kept * self.factor].reshape(kept, self.factor).mean(axis=1)
            return _filtered(taps, values)[:: self.factor][:kept]

        def part(matrix: Array, holds: tuple[Hold | None, ...]) -> Array:
            columns = [thinned(matrix[:, j], hold) for j, hold in enumerate(holds)]
            return np.column_stack(columns) if columns else np.empty((kept, 0))

        auxiliary = record.auxiliary
        return replace(
            record,
            time=record.time[:: self.factor][:kept],
            inputs=part(record.inputs, tuple(c.hold for c in record.input_channels)),
            outputs=part(record.outputs, (None,) * len(record.output_channels)),
            output_channels=tuple(replace(c, rounding=0.0) for c in record.output_channels),
            auxiliary=None if auxiliary is None else part(auxiliary, (None,) * auxiliary.shape[1]),
            masked=masked_of(_thinned(record.levels, self.factor, kept)) if record.masked else (),
            absent=None if record.absent is None else self._fewer(record.absent, kept),
        )

    def _fewer(self, absent: Cells, kept: int) -> Cells:
        """The absent cells (kept, n_y): those that the filter mixes with one."""
        columns = [_thinned(column.astype(np.int8), self.factor, kept) for column in absent.T]
        return np.column_stack(columns).astype(bool)


def _thinned(levels: Levels, factor: int, kept: int) -> Levels:
    """Levels (kept,) of a mask: each the highest among the old samples from the new one before it to the new
    one after it, which its filter mixes most."""
    padded = np.pad(levels, (factor - 1, factor))
    return np.array([padded[k * factor : (k + 2) * factor - 1].max() for k in range(kept)], dtype=np.int8)


def _length(factor: int) -> tuple[int, float]:
    """Number of taps, odd, and shape of the Kaiser window."""
    count, beta = signal.kaiserord(ATTENUATION, (1 - PASS_BAND) / factor)
    return int(count) | 1, float(beta)


def _low_pass(factor: int) -> Array:
    """Taps (odd number,) of the anti-alias filter, their sum 1."""
    count, beta = _length(factor)
    return signal.firwin(count, (1 + PASS_BAND) / 2 / factor, window=("kaiser", beta))


def _filtered(taps: Array, values: Array) -> Array:
    """``values`` (n,) through the symmetric filter, continued by odd reflection at both ends."""
    reach = len(taps) // 2
    if reach == 0:
        return values
    before = 2 * values[0] - values[reach:0:-1]
    after = 2 * values[-1] - values[-2 : -reach - 2 : -1]
    return signal.oaconvolve(np.concatenate([before, values, after]), taps, mode="valid")
