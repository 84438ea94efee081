"""What records do not tell: a parameter that they leave open, or that is bound to a few samples; and a
held-out record that was fitted."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from hybridid.advice.advice import Advice
from hybridid.effects.sampled import PATHS
from hybridid.estimators.estimate import Estimate, EstimatedParameter
from hybridid.estimators.problem import Problem
from hybridid.quantities import estimated, number
from hybridid.records.record import Record

MANY = 10
"""Samples that a delay or a lag may take at most, as at samples of 1 ms."""


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


def bound_to_few_samples(problem: Problem, estimate: Estimate) -> list[EstimatedParameter]:
    """Each delay or lag of a signal that ends at a largest value of fewer than ``MANY`` samples: the bounds
    of the library are those of samples of 1 ms. A trace widens them by itself."""
    ports = [port.name for port in problem.model.plant.ports if port.kind in PATHS]
    most = MANY * problem.windows.dt
    return [
        one
        for one in estimate.parameters
        if one.unit == "s" and one.name.partition(".")[0] in ports
        if one.at_bound and 0 < one.upper < min(2 * one.value, most)
    ]


def faster_than_the_samples(problem: Problem, estimate: Estimate) -> Iterator[Advice]:
    """Of each parameter that is ``bound_to_few_samples``, the keys that allow it more."""
    step = problem.windows.dt
    fixed = [p.name for p in problem.model.parameters if p.fixed]
    for one in bound_to_few_samples(problem, estimate):
        enough, window = number(MANY * step, 2), f"{one.name.rpartition('.')[0]}.window"
        also = f" parameters.{window}.guess={enough}" if window in fixed else ""
        yield Advice(
            "bound",
            f"{one.name} ends at its bound of {number(one.upper, 2)} s, fewer than {MANY} samples of "
            f"{number(step, 2)} s: the library's bounds are those of samples of 1 ms; "
            f"parameters.{one.name}.upper={enough}{also} allows {MANY}",
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
