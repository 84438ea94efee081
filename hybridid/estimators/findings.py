"""From where an optimiser stopped to an ``Estimate``: what to say of it, and what to warn of."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from hybridid.declarations import Parameter
from hybridid.estimators.differences import differences
from hybridid.estimators.estimate import Estimate, EstimatedParameter, Left, Solution
from hybridid.estimators.floor import Floor
from hybridid.estimators.problem import Problem
from hybridid.estimators.uncertainty import Uncertainty
from hybridid.quantities import quantity, with_unit
from hybridid.settings.fit import FitSettings
from hybridid.simulation.stability import MOST, substeps_wanted

VAGUE = 0.5
"""A standard error above this share of the value (or of its scale) marks a parameter that
the records do not identify."""
NEAR_BOUND = 1e-6
SAME_OPTIMUM = 1e-3
"""Relative difference of cost below which two starts count as arrived at one optimum."""
MOSTLY = 0.9
"""Share of a standard error above which it is called that of the smoothing of sign(v)."""


def estimate_of(
    problem: Problem,
    solution: Solution,
    doubt: Uncertainty,
    floor: Floor,
    settings: FitSettings,
    seconds: Mapping[str, float],
    starts: tuple[float, ...],
) -> Estimate:
    """The solution in the words of an ``Estimate``; ``starts`` are the costs at which each start ended."""
    model = problem.model
    parameters = tuple(
        _estimated(model.parameters[k], float(solution.p[k]), float(std), float(moved), solution.converged)
        for k, std, moved in zip(problem.positions, doubt.std, doubt.smoothing, strict=True)
    )
    known = {
        q.name: float(v)
        for q, v in zip(model.parameters, solution.p, strict=True)
        if q.name not in problem.free
    }
    values = {q.name: float(v) for q, v in zip(model.parameters, solution.p, strict=True)}
    each, together = differences(model, problem.free, values, doubt.covariance)
    found = Estimate(
        parameters=parameters,
        known=known,
        correlation=doubt.correlation,
        initial_states=solution.x0,
        origin=problem.windows.origin,
        cost=solution.cost,
        status=solution.status,
        converged=solution.converged,
        iterations=solution.iterations,
        seconds=seconds,
        substeps=problem.windows.substeps,
        settings=settings,
        history=solution.history,
        starts=starts,
        warnings=_warnings(problem, solution, parameters, starts),
        left=_left(problem, floor),
        differences=each,
        together=together,
    )
    return found if solution.converged else found.withheld()


def _left(problem: Problem, floor: Floor) -> tuple[Left, ...]:
    columns = (floor.left, floor.noise, floor.simulation, floor.step, floor.louder)
    rows = zip(problem.model.outputs, *(c.tolist() for c in columns), floor.exceeded.tolist(), strict=True)
    return tuple(Left(output.name, output.unit, *numbers) for output, *numbers in rows)


def _estimated(
    declared: Parameter, value: float, std: float, smoothing: float, converged: bool
) -> EstimatedParameter:
    span = declared.scale * NEAR_BOUND
    return EstimatedParameter(
        name=declared.name,
        value=value,
        std=std if converged else math.nan,
        unit=declared.unit,
        lower=declared.lower,
        upper=declared.upper,
        at_bound=bool(value <= declared.lower + span or value >= declared.upper - span),
        identifiable=not converged
        or bool(np.isfinite(std) and std <= VAGUE * max(abs(value), declared.scale)),
        meaning=declared.meaning,
        smoothing=smoothing,
    )


def _warnings(
    problem: Problem, solution: Solution, parameters: Sequence[EstimatedParameter], starts: tuple[float, ...]
) -> tuple[str, ...]:
    notes = []
    if not solution.converged:
        notes.append(f"NOT CONVERGED: {solution.status}; the estimates are not at an optimum")
    for p in parameters:
        if p.at_bound:
            said = with_unit(f"{p.value:.6g}", p.unit)
            notes.append(f"{p.name} = {said} is at a bound [{p.lower:g}, {p.upper:g}]")
        if not p.identifiable:
            notes.append(f"{p.name} is not identifiable from these records")
    smeared = [p.name for p in parameters if np.isfinite(p.std) and abs(p.smoothing) > MOSTLY * p.std]
    if smeared:
        widths = [p for p in problem.model.parameters if p.smooths]
        over = " and ".join(f"{p.name} = {quantity(p.guess, p.unit)}" for p in widths)
        notes.append(
            f"the error of {', '.join(smeared)} is mostly that of smoothing sign(v) over {over}: where the "
            "machine truly sticks, a smaller one says more"
        )
    used, integrator = problem.windows.substeps, problem.shooter.integrator
    needed = substeps_wanted(problem.model, solution.p, problem.records, integrator=integrator)
    if needed > used:
        wanted, remedy = f"{needed}", f"try estimator.substeps={needed}"
        if needed > MOST:
            wanted = f"more than {MOST}"
            remedy = "a larger epsilon of its port, or a lower upper bound of a friction or stiffness, helps"
        notes.append(
            f"the fitted model wants {wanted} steps of {integrator} a sample, {used} were used: what it "
            f"leaves may be theirs; {remedy}"
        )
    return (*notes, *several_valleys(starts))


def several_valleys(starts: Sequence[float]) -> tuple[str, ...]:
    """Whether some descents, which ended at the costs ``starts``, missed the lowest: one line, or none."""
    apart = sum(1 for cost in starts if cost > min(starts) * (1 + SAME_OPTIMUM))
    if not apart:
        return ()
    said = f"{apart} of {len(starts)} starts ended at a higher cost"
    return (f"{said}: the cost has several valleys, and the lowest one found is kept",)
