"""Parameters that the records determine only together: two that are collinear, several with one scale.

The outputs of ``k_t u/R = J a + F`` stay the same if k_t, J and F are all multiplied by one factor. The
logarithms of such a group then enter a null direction of the information matrix with equal weights.
Source: Bellman, Åström (1970), On structural identifiability, Mathematical Biosciences 7, 329-339.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from hybridid.advice.advice import Advice
from hybridid.estimators.estimate import Estimate, EstimatedParameter
from hybridid.estimators.problem import Problem
from hybridid.estimators.uncertainty import jacobian_of
from hybridid.naming import listed
from hybridid.quantities import fixed

Array = NDArray[np.float64]
COLLINEAR = 0.98
"""Size of the correlation from which two parameters count as collinear."""
NULL = 1e-7
"""Singular value, over the largest, below which no sample shows a direction: the columns have length one."""
TAKES_PART = 1e-3
"""Share of a null direction's largest entry above which a parameter is in it."""
ALIKE = 1e-3
"""Relative difference of the entries of parameters that share a scale."""
SMALL = 1e-6
"""Share of its scale below which a value counts as zero: no factor changes it."""


def at_bound(estimate: Estimate, but: Sequence[EstimatedParameter] = ()) -> Iterator[Advice]:
    """Of each parameter at its bound, ``but`` for some, the one that it is collinear with. A bound of zero is
    physics: a friction that is not there does not want wider bounds."""
    if not estimate.converged:
        return
    told: set[frozenset[str]] = set()
    for k, one in enumerate(estimate.parameters):
        if not one.at_bound or one.value == 0 or one in but:
            continue
        sizes = np.abs(np.where(np.arange(len(estimate.parameters)) == k, 0.0, estimate.correlation[k]))
        other = estimate.parameters[int(np.argmax(sizes))]
        pair = frozenset((one.name, other.name))
        if sizes.max(initial=0.0) >= COLLINEAR and pair not in told:
            told.add(pair)
            yield Advice("bound", _together(one, other, float(sizes.max())))


def _together(one: EstimatedParameter, other: EstimatedParameter, size: float) -> str:
    return (
        f"{one.name} is at its bound and collinear with {other.name} (correlation of size "
        f"{fixed(size, 3)}): with wider bounds the two run on together, take up what the model lacks, and "
        "may predict other records worse; fix one of the two at a value that you know, as in "
        f"parameters.{other.name}.fixed=..."
    )


def shared_scale(problem: Problem, estimate: Estimate) -> Iterator[Advice]:
    """Of each group of parameters that one factor multiplies without a change of the outputs."""
    unknown = [p for p in estimate.parameters if not p.identifiable]
    if len(unknown) < 2 and estimate.converged:
        return
    p = problem.model.values(estimate.values)
    jacobian = jacobian_of(problem, p, estimate.initial_states)
    if jacobian is None:
        return
    declared = np.array([problem.model.parameters[k].scale for k in problem.positions])
    value = p[problem.positions]
    zero = np.abs(value) <= SMALL * declared
    weights = _null_directions(jacobian, np.where(zero, declared, value))
    names = np.array(problem.free)
    for group in _groups(weights, ~zero):
        others = [name for name, row in zip(names, weights, strict=True) if np.abs(row).max(initial=0.0) > 0]
        beside = [name for name in others if name not in names[group]]
        along = f", with {listed(beside)} to match," if len(beside) and weights.shape[1] == 1 else ""
        yield Advice(
            "scale",
            f"{listed([str(n) for n in names[group]])} share one free scale: all of them times one factor"
            f"{along} leave the outputs as they are; fix one of them at a value that you know, as in "
            f"parameters.{names[group][0]}.fixed=...",
        )


def _null_directions(jacobian: Array, size: Array) -> Array:
    """Directions (n, m) of the parameters, each over its ``size``, that no output shows; their small entries
    are zero. A parameter that acts on nothing is in none of them."""
    by_log = jacobian * size
    norms = np.linalg.norm(by_log, axis=0)
    felt = norms > 0
    if not felt.any():
        return np.zeros((len(size), 0))
    _, singular, directions = np.linalg.svd(by_log[:, felt] / norms[felt], full_matrices=False)
    null = directions[singular <= NULL * singular[0]].T / norms[felt][:, None]
    weights = np.zeros((len(size), null.shape[1]))
    weights[felt] = null
    largest = np.abs(weights).max(axis=0, initial=0.0)
    return np.where(np.abs(weights) > TAKES_PART * largest, weights, 0.0)


def _groups(weights: Array, possible: NDArray[np.bool_]) -> Iterator[Array]:
    """Indices of the parameters with equal weights in every null direction, two or more."""
    left = [k for k in np.flatnonzero(possible) if np.abs(weights[k]).max(initial=0.0) > 0]
    while left:
        first = weights[left[0]]
        alike = [k for k in left if np.allclose(weights[k], first, rtol=0, atol=ALIKE * np.abs(first).max())]
        left = [k for k in left if k not in alike]
        if len(alike) > 1:
            yield np.array(alike)
