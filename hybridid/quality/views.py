"""What a fitted model explains over its horizons and in free run, beside what doing nothing does."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.estimate import Estimate
from hybridid.estimators.problem import Problem
from hybridid.model import Model
from hybridid.quality.verdict import View
from hybridid.records.record import Record
from hybridid.simulation.simulate import Diverged
from hybridid.validation import free_run

Array = NDArray[np.float64]


def views_of(
    model: Model, records: Sequence[Record], estimate: Estimate, problem: Problem
) -> tuple[View, ...]:
    """Each output over the horizons of ``problem``, which is that of the fit, and in free run."""
    shot = problem.shooter(estimate.initial_states, model.values(estimate.values))
    windows = problem.windows
    own = np.where(windows.cells, windows.outputs - shot.outputs, np.nan)[windows.used]
    if estimate.settings.horizon is None:
        return tuple(_rows(model, records, own, None, _constant(records)))
    horizon = estimate.settings.horizon * records[0].dt
    held = np.minimum(_held(problem), _constant(records))
    over_horizons = _rows(model, records, own, horizon, held)
    return (*over_horizons, *_rows(model, records, _free(model, records, estimate), None, _constant(records)))


def _rows(
    model: Model, records: Sequence[Record], error: Array, horizon: float | None, nothing: Array
) -> Iterator[View]:
    spread = _constant(records)
    with np.errstate(over="ignore", invalid="ignore"):
        rmse = np.sqrt(_mean(error**2))
        r2 = 1.0 - np.square(rmse / np.where(spread > 0, spread, np.nan))
    for output, *numbers in zip(model.outputs, rmse.tolist(), r2.tolist(), nothing.tolist(), strict=True):
        yield View(output.name, output.unit, horizon, *numbers)


def _free(model: Model, records: Sequence[Record], estimate: Estimate) -> Array:
    """Errors (n, n_y) of the free runs of all records; nan if one diverges."""
    settings = estimate.settings
    try:
        runs = [
            free_run(
                model, estimate.values, r, settings.initial_state, settings.integrator, estimate.substeps
            )
            for r in records
        ]
    except Diverged:
        return np.full((1, len(model.outputs)), np.nan)
    return np.concatenate([run.error for run in runs])


def _constant(records: Sequence[Record]) -> Array:
    """RMS (n_y,) of the outputs about the mean of each record."""
    about = [(r.counted - np.nanmean(r.counted, axis=0)) ** 2 for r in records]
    return np.sqrt(np.nanmean(np.concatenate(about), axis=0))


def _held(problem: Problem) -> Array:
    """RMS (n_y,) of the outputs about the value with which each horizon begins."""
    windows = problem.windows
    moved = np.where(windows.cells, windows.outputs - windows.outputs[:, :1], np.nan)
    return np.sqrt(np.nanmean(moved[windows.used] ** 2, axis=0))


def _mean(squares: Array) -> Array:
    """Mean of (n, n_y) over what was measured, (n_y,); nan where nothing is."""
    measured = np.isfinite(squares)
    with np.errstate(invalid="ignore"):
        return np.where(measured, squares, 0.0).sum(axis=0) / measured.sum(axis=0)
