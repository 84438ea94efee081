"""What records do not tell: a parameter that they leave open, and a held-out record that was fitted."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from hybridid.advice.advice import Advice
from hybridid.estimators.estimate import Estimate
from hybridid.quantities import estimated
from hybridid.records.record import Record


def left_open(estimate: Estimate) -> Iterator[Advice]:
    """Each parameter that is positive by its bounds and whose standard error is larger than its value."""
    if not estimate.converged:
        return
    for one in estimate.parameters:
        if one.lower > 0 and one.std > one.value:  # of no std, which is nan, nothing is said
            yield Advice(
                "open",
                f"{one.name} is {estimated(one.value, one.std, one.unit)}: its standard error is larger than "
                "itself, so the fit does not tell it; take longer horizons or livelier records, or fix it at "
                f"a value that you know, as in parameters.{one.name}.fixed=...",
            )


def judged_by_itself(fitted: Sequence[Record], held_out: Sequence[Record]) -> Iterator[Advice]:
    """Each held-out record that holds the very samples of one that was fitted."""
    for record in held_out:
        same = [one.name for one in fitted if one.name != record.name and _same(one, record)]
        if same:
            yield Advice(
                "same",
                f"record {record.name} holds the samples of {same[0]}, which was fitted: it judges nothing; "
                "give it a file of its own",
            )


def _same(one: Record, other: Record) -> bool:
    return np.array_equal(one.outputs, other.outputs) and np.array_equal(one.inputs, other.inputs)
