"""``advise``: a fit and its records in, advice out."""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.advice.advice import Advice
from hybridid.advice.collinear import at_bound, shared_scale
from hybridid.advice.decay import free_decay
from hybridid.advice.horizon import unsuitable_horizon
from hybridid.advice.ranges import out_of_range
from hybridid.advice.relaxation import relaxation
from hybridid.advice.unfinished import few_starts, stopped
from hybridid.advice.untold import faster_than_the_samples, judged_by_itself, left_open
from hybridid.estimators.estimate import Estimate
from hybridid.estimators.problem import Problem
from hybridid.records.record import Record


def advise(problem: Problem, estimate: Estimate, held_out: Sequence[Record] = ()) -> tuple[Advice, ...]:
    """What to do about ``estimate``, the solution of ``problem``; ``held_out`` are records that judge it."""
    fast = [*faster_than_the_samples(problem, estimate)]
    told = [one.said.partition(" ")[0] for one in fast]
    return (
        *(one for one in at_bound(estimate) if one.said.partition(" ")[0] not in told),
        *shared_scale(problem, estimate),
        *free_decay(problem.records),
        *relaxation(problem.records),
        *unsuitable_horizon(problem, estimate),
        *stopped(estimate),
        *few_starts(estimate),
        *left_open(estimate),
        *fast,
        *out_of_range(problem, estimate, held_out),
        *judged_by_itself(problem.records, held_out),
    )
