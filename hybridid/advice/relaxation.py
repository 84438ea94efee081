"""A relaxation that nothing drives: what relaxes is a function of time alone, so the two are not told apart.

A body that cools or a vehicle that coasts down takes each value once. A loss over the value and a loss that
changes with time predict the same course, and so does one over the way gone. A second record that begins at
another value tells them apart.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from hybridid.advice.advice import Advice
from hybridid.advice.decay import ALONE, MOST, made_by_an_output
from hybridid.naming import listed
from hybridid.quantities import fixed, quantity
from hybridid.records.record import Record

Array = NDArray[np.float64]


def relaxation(records: Sequence[Record]) -> Iterator[Advice]:
    """Whether an output of all ``records``, which nothing drives, is a monotone function of time in them."""
    inputs = ((column, record) for record in records for column in record.inputs.T)
    if any(column.any() and not made_by_an_output(column, record) for column, record in inputs):
        return
    from scipy.stats import spearmanr  # takes a while, and most machines are driven

    for k, channel in enumerate(records[0].output_channels):
        time, value = (np.concatenate(part) for part in zip(*(_course(r, k) for r in records), strict=True))
        rank = float(spearmanr(time, value).statistic)
        if abs(rank) < -ALONE:
            continue
        first, last = (quantity(float(v), channel.unit, 2) for v in value[np.argsort(time)[[0, -1]]])
        yield Advice(
            "decay",
            f"{channel.name} and time cannot be told apart in {listed([r.name for r in records])}: it only "
            f"goes from {first} to {last} (rank correlation {fixed(rank, 2)}), which a loss over "
            f"{channel.name} and one that changes with time explain alike; a record that begins elsewhere, "
            "or a driven one, tells them apart",
        )
        return


def _course(record: Record, k: int) -> tuple[Array, Array]:
    """Times since the start [s] and means of output ``k`` of each piece of a record."""
    pieces = np.array_split(np.arange(record.n), min(MOST, record.n))
    time = [record.time[piece].mean() - record.time[0] for piece in pieces]
    return np.array(time), np.array([record.outputs[piece, k].mean() for piece in pieces])
