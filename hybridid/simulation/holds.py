"""The course of inputs between their samples: held, linear or band-limited.

A Runge-Kutta step of length h needs its input at t, t + h/2 and t + h. A held input has one value
for all three. Any other input is evaluated on a grid of ``2 * substeps + 1`` points from one sample to the
next.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from hybridid.records.record import Record

Array = NDArray[np.float64]
SINC_HALF_WIDTH = 32
"""Samples on each side that band-limited interpolation uses."""
NEIGHBOURS = SINC_HALF_WIDTH + 1
"""Samples on each side of a part of a record that the course of its inputs depends on."""
KAISER_BETA = 8.0
"""About 80 dB of stop-band attenuation."""


def all_held(record: Record) -> bool:
    """Whether every input is held between its samples."""
    return all(c.hold == "zoh" for c in record.input_channels)


def stage_inputs(record: Record, substeps: int, start: int = 0, stop: int | None = None) -> Array:
    """Inputs at the integrator's stages, shape (n, n_u) if all held, else (n, n_u (2 s + 1)).

    Row k belongs to the step from sample k to k + 1; in a row, the stage is the slower index. The last
    sample of the record has no successor: its row repeats it. ``start`` and ``stop`` choose samples.
    """
    stop = record.n if stop is None else stop
    if all_held(record):
        return np.array(record.inputs[start:stop])
    stages, first = 2 * substeps, max(0, start - NEIGHBOURS)
    near = record.inputs[first : stop + NEIGHBOURS]
    columns = [_fine(near[:, j], c.hold, stages) for j, c in enumerate(record.input_channels)]
    return np.stack(columns, axis=-1).reshape(len(near), -1)[start - first : stop - first]


def _fine(samples: Array, hold: str, stages: int) -> Array:
    """One input at ``stages + 1`` points from each sample to the next, shape (n, stages + 1)."""
    n = len(samples)
    if hold == "zoh":
        return np.repeat(samples[:, None], stages + 1, axis=1)
    if hold == "foh":
        following = np.append(samples[1:], samples[-1])
        weight = np.linspace(0.0, 1.0, stages + 1)
        return samples[:, None] * (1 - weight) + following[:, None] * weight
    fine = _bandlimited(samples, stages)
    index = np.arange(n)[:, None] * stages + np.arange(stages + 1)
    return fine[np.minimum(index, (n - 1) * stages)]


def _bandlimited(samples: Array, factor: int) -> Array:
    """Kaiser-windowed sinc interpolation onto a grid ``factor`` times finer.

    The ends are continued by odd reflection. Source: Oppenheim, Schafer (2010),
    Discrete-Time Signal Processing, sec. 4.6.2 and 7.6.
    """
    width = SINC_HALF_WIDTH
    padded = np.pad(samples, width, mode="reflect", reflect_type="odd")
    fine = signal.resample_poly(padded, factor, 1, window=_taps(factor))
    return fine[width * factor : width * factor + (len(samples) - 1) * factor + 1]


@lru_cache(maxsize=16)
def _taps(factor: int) -> Array:
    return np.asarray(
        signal.firwin(2 * SINC_HALF_WIDTH * factor + 1, 1.0 / factor, window=("kaiser", KAISER_BETA))
    )
