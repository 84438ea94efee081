"""A free decay: its amplitude falls with time alone, so the two cannot be told apart as causes.

A friction over the amplitude and a friction that drifts predict the same decay. A second decay that begins at
another amplitude tells them apart, and so does a machine that is driven.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from hybridid.advice.advice import Advice
from hybridid.naming import listed
from hybridid.quantities import fixed, quantity
from hybridid.records.record import Record

Array = NDArray[np.float64]
PERIODS = 2.0
"""Of the oscillation in a piece over which its amplitude is taken."""
FEWEST, MOST = 5, 20
"""Pieces of a record."""
ALONE = -0.95
"""Rank correlation of amplitude and time below which they are one."""
FALLS = 1.5
"""Ratio of the largest and the smallest amplitude of what counts as a decay."""
SAME = 1e-3
"""Of the largest rate: a rate and an output that differ by no more are one."""
SETTLED = 5.0
"""Ratio of the variations before and after from which a record has settled."""


def free_decay(records: Sequence[Record]) -> Iterator[Advice]:
    """Whether all ``records`` are decays that nothing drives, their amplitude a function of time."""
    if not all(undriven(record) for record in records):
        return
    from scipy.stats import spearmanr  # takes a while, and most machines are driven

    for k, channel in enumerate(records[0].output_channels):
        courses = [_amplitudes(record, k) for record in records]
        if any(course is None for course in courses):
            continue
        time, amplitude = (np.concatenate([c[i] for c in courses if c is not None]) for i in (0, 1))
        rank = float(spearmanr(time, amplitude).statistic)
        if rank <= ALONE and amplitude.max() >= FALLS * amplitude.min() > 0:
            high, low = (quantity(float(a), channel.unit, 2) for a in (amplitude.max(), amplitude.min()))
            yield Advice(
                "decay",
                f"amplitude and time cannot be told apart in {listed([r.name for r in records])}: a free "
                f"decay of {channel.name} from {high} to {low} (rank correlation {fixed(rank, 2)}), which a "
                "friction over the amplitude and a friction that drifts with time explain alike; a decay "
                "from another amplitude, or a driven record, tells them apart",
            )
            return


def undriven(record: Record) -> bool:
    """Whether no input of ``record`` ever changes, but for one that an output made."""
    return not any(np.ptp(column) > 0 and not made_by_an_output(column, record) for column in record.inputs.T)


def made_by_an_output(column: Array, record: Record) -> bool:
    """Whether an input (n,) is the integral of an output, as the angle is that of the speed: it drives
    nothing."""
    rate = np.diff(column) / record.dt
    means = 0.5 * (record.outputs[1:] + record.outputs[:-1])
    return any(
        np.allclose(rate, mean, rtol=0.0, atol=SAME * float(np.abs(mean).max(initial=0.0)))
        for mean in means.T
        if mean.any()
    )


def settles(record: Record, after: float) -> bool:
    """Whether nothing drives ``record``, and ``after`` that time [s] an output varies by less than a fifth of
    what it did before: what is small there shows little of the machine."""
    late = record.time >= after
    falls = SETTLED * record.outputs[late].std(axis=0) < record.outputs[~late].std(axis=0)
    return undriven(record) and bool(falls.any())


def coasts(record: Record, after: float) -> bool:
    """Whether something drives ``record``, but nothing does ``after`` that time [s]: no input changes there.
    What judges should be driven as what is fitted. Where a machine coasts, its place, its speed and the time
    go together, and what takes one for another is not refuted."""
    late = record.time >= after
    driving = [u for u in record.inputs.T if not made_by_an_output(u, record)]
    return not undriven(record) and not any(np.ptp(u[late]) > 0 for u in driving)


def swing(record: Record) -> float:
    """Period [s] of the strongest oscillation of the output that oscillates fastest."""
    centred = record.outputs - record.outputs.mean(axis=0)
    return record.n * record.dt / max(_cycles(y) for y in centred.T)


def _cycles(y: Array) -> int:
    """How often ``y`` (n,), without its mean, oscillates at its strongest frequency."""
    return int(np.argmax((np.abs(np.fft.rfft(y)) ** 2)[1:])) + 1


def _amplitudes(record: Record, k: int) -> tuple[Array, Array] | None:
    """Time [s] since the start, and amplitude, of each piece of output ``k``; None where it does not
    oscillate often enough."""
    y = record.outputs[:, k] - record.outputs[:, k].mean()
    count = min(MOST, int(_cycles(y) / PERIODS))
    if count < FEWEST:
        return None
    pieces = np.array_split(np.arange(record.n), count)
    time = np.array([record.time[piece].mean() - record.time[0] for piece in pieces])
    return time, np.sqrt(2.0) * np.array([y[piece].std() for piece in pieces])
