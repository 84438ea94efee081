"""Predictions free-run over the whole record, and over short horizons; ``in_loop`` has a third view.

In a free run of a plant that integrates, a small change of friction adds up to millimetres at the end of a
long record, whatever else the model describes well. Short horizons, each from its own estimated initial
state, show how good the equations are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import carries_nothing
from hybridid.estimators.method import GAUSS_NEWTON, Method
from hybridid.estimators.problem import Problem, build_problem
from hybridid.estimators.start import best_initial_states, x0_candidates
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.settings.choices import View
from hybridid.simulation.chosen import integrator_for
from hybridid.simulation.matching import check_records
from hybridid.simulation.shooter import Shot
from hybridid.simulation.simulate import Diverged
from hybridid.simulation.stability import in_enough_steps, near, stays_near, substeps_to_predict

Array = NDArray[np.float64]
VIEWS: tuple[View, ...] = get_args(View)


@dataclass(frozen=True)
class Prediction:
    """A model's outputs and the measured ones.

    Shapes: ``time`` (n,) s, ``measured`` and ``predicted`` (n, n_y), ``states`` (n, n_x). ``measured`` is nan
    where an output was not measured.
    ``breaks`` are the first samples of the horizons, ``initial_states`` (w, n_x) the states there.
    ``rows`` (n,) are the samples of the record that it shows, if these are not its first: masked ones are
    left out.
    """

    record: str
    view: str
    provenance: str
    time: Array
    measured: Array
    predicted: Array
    states: Array
    output_names: tuple[str, ...]
    output_units: tuple[str, ...]
    state_names: tuple[str, ...]
    breaks: tuple[int, ...]
    initial_states: Array
    rows: NDArray[np.int64] | None = None

    def of(self, values: Array) -> Array:
        """Of ``values`` (n of the record, ...) those at the samples that the prediction shows, (n, ...)."""
        return values[: len(self.time)] if self.rows is None else values[self.rows]

    @property
    def starts(self) -> NDArray[np.int64]:
        """Where in ``time`` each horizon begins, (w,)."""
        first = np.array(self.breaks)
        return first - first[0] if self.rows is None else np.searchsorted(self.rows, first)

    @property
    def holes(self) -> Array:
        """Times [s] of the last sample before and the first after each masked stretch, (h, 2)."""
        return np.empty((0, 2)) if self.rows is None else holes_of(self.time, self.rows)

    @property
    def error(self) -> Array:
        """``measured - predicted``, (n, n_y)."""
        return self.measured - self.predicted

    def samples_of(self, column: int) -> tuple[NDArray[np.bool_], NDArray[np.int64] | None]:
        """At which of its samples an output was measured, (n,), and their ``rows`` in the record, (m,)."""
        kept = np.isfinite(self.measured[:, column])
        if kept.all():
            return kept, self.rows
        rows = self.breaks[0] + np.arange(len(kept)) if self.rows is None else self.rows
        return kept, rows[kept]


def holes_of(time: Array, rows: NDArray[np.int64]) -> Array:
    """``time`` (n,) of the last sample before and the first after each gap in ``rows`` (n,), (h, 2)."""
    last = np.flatnonzero(np.diff(rows) > 1)
    return np.stack([time[last], time[last + 1]], axis=1)


def free_run(
    model: Model,
    values: Mapping[str, float],
    record: Record,
    initial_state: str = "estimated",
    integrator: str = "rk4",
    substeps: int | None = None,
    method: Method = GAUSS_NEWTON,
) -> Prediction:
    """Simulate the whole record from one initial state, and anew after each masked part not simulated.

    ``initial_state`` is "estimated" (it fits the record best at these parameters) or "measured" (from the
    first samples). ``substeps`` are the integration steps a sample, such as those of an estimate; by default
    as many as stability and accuracy need. With more it is simulated only where it would leave the record.
    ``method`` estimates the initial state.

    Raises:
        Diverged: if the simulation leaves the record (``hybridid.simulation.stability.near``).
    """
    return _predict(model, values, record, None, initial_state, "free_run", integrator, substeps, method)


def horizon_run(
    model: Model,
    values: Mapping[str, float],
    record: Record,
    horizon: int,
    integrator: str = "rk4",
    substeps: int | None = None,
    method: Method = GAUSS_NEWTON,
) -> Prediction:
    """Simulate each horizon of ``horizon`` samples from its own estimated initial state.

    ``substeps`` and ``method`` as for ``free_run``.

    Raises:
        Diverged: if the simulation leaves the record (``hybridid.simulation.stability.near``).
    """
    return _predict(model, values, record, horizon, "estimated", "horizon", integrator, substeps, method)


def _predict(
    model: Model,
    values: Mapping[str, float],
    record: Record,
    horizon: int | None,
    initial_state: str,
    view: str,
    integrator: str,
    substeps: int | None,
    method: Method,
) -> Prediction:
    if initial_state not in ("estimated", "measured"):
        raise ValueError(f"validate.initial_state is {initial_state!r}, allowed: estimated, measured")
    check_records(model, [record])
    p = model.values(values)
    estimate = initial_state == "estimated"
    integrator = integrator_for(model, p, [record], integrator)

    def run(steps: int) -> tuple[Problem, Array, Shot]:
        problem = build_problem(model, [record], horizon, steps, estimate, free=(), integrator=integrator)
        x0 = initial_states(problem, p, method) if estimate else problem.measured_x0()
        return problem, x0, problem.shooter(x0, p)

    steps = substeps or substeps_to_predict(model, p, [record], integrator=integrator)
    problem, x0, shot = in_enough_steps(run, lambda found: _stays_near(found, record), steps)
    used = problem.windows.used
    time, predicted, states = (a[used] for a in (problem.windows.time, shot.outputs, shot.states))
    stays = near(predicted, record)
    if not stays.all():
        first = int(np.argmin(stays))
        raise Diverged(f"simulation of record {record.name} diverged at t = {time[first]:.4g} s")
    return Prediction(
        record=record.name,
        view=view,
        provenance=record.provenance,
        time=time,
        measured=np.where(problem.windows.cells, problem.windows.outputs, np.nan)[used],
        predicted=predicted,
        states=states,
        output_names=tuple(s.name for s in model.outputs),
        output_units=tuple(s.unit for s in model.outputs),
        state_names=tuple(s.name for s in model.states),
        breaks=tuple(start for _, start, _ in problem.windows.origin),
        initial_states=x0,
        rows=_rows(problem) if record.masked else None,
    )


def _stays_near(found: tuple[Problem, Array, Shot], record: Record) -> bool:
    problem, _, shot = found
    return stays_near(shot.outputs[problem.windows.used], record)


def _rows(problem: Problem) -> NDArray[np.int64]:
    """The samples of the one record that are in use, (n,)."""
    starts = np.array([start for _, start, _ in problem.windows.origin])
    return (starts[:, None] + np.arange(problem.windows.length))[problem.windows.used]


def initial_states(problem: Problem, p: Array, method: Method = GAUSS_NEWTON) -> Array:
    """The initial state of each horizon with the best fit at fixed parameters, (w, n_x)."""
    candidates = x0_candidates(problem, p)
    start = best_initial_states(problem, p, candidates)
    found = method.solve(problem, p, start).x0
    return best_initial_states(problem, p, [found, *candidates]) if carries_nothing(problem) else found
