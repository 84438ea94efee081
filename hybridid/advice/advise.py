"""``advise``: a fit and its records in, advice out."""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.advice.advice import Advice
from hybridid.advice.collinear import at_bound, shared_scale
from hybridid.advice.decay import free_decay
from hybridid.advice.disagreement import recordings_disagree
from hybridid.advice.horizon import unsuitable_horizon
from hybridid.advice.ranges import out_of_range
from hybridid.advice.relaxation import relaxation
from hybridid.advice.smoothing import wide_smoothing
from hybridid.advice.unequal import unequal_outputs
from hybridid.advice.unfinished import few_starts, stopped
from hybridid.advice.untold import (
    bound_to_few_samples,
    faster_than_the_samples,
    judged_by_itself,
    left_open,
)
from hybridid.estimators.estimate import Estimate
from hybridid.estimators.problem import Problem
from hybridid.records.record import Record


def advise(problem: Problem, estimate: Estimate, held_out: Sequence[Record] = ()) -> tuple[Advice, ...]:
    """What to do about ``estimate``, the solution of ``problem``; ``held_out`` are records that judge it."""
    return (
        *at_bound(estimate, bound_to_few_samples(problem, estimate)),
        *shared_scale(problem, estimate),
        *free_decay(problem.records),
        *relaxation(problem.records),
        *unsuitable_horizon(problem, estimate),
        *unequal_outputs(problem.records),
        *recordings_disagree(problem, estimate),
        *wide_smoothing(problem, estimate),
        *stopped(estimate),
        *few_starts(estimate),
        *left_open(estimate),
        *faster_than_the_samples(problem, estimate),
        *out_of_range(problem, estimate, held_out),
        *judged_by_itself(problem.records, held_out),
    )
