"""Resampling onto an even time grid, when a user asks for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from hybridid.records.channel import Array, Hold, RecordError
from hybridid.records.checks import check_increasing

GAP = 3.0  # of the usual step; a longer gap is reported, because its samples are interpolated, not measured
COARSER = 1.5  # of the usual step; a longer new step without a filter causes aliasing


@dataclass(frozen=True)
class Resample:
    """An even grid of step ``dt`` [s], by linear interpolation or by monotone cubics (PCHIP).

    PCHIP does not overshoot between samples. A held input (``zoh``) is a staircase with either
    method: its value at a grid point is its mean over the step that follows, which keeps its
    integral. A line through the staircase would act half a sample early; the last value before
    each grid point would act up to one sample late.

    Source: Fritsch, Carlson (1980), SIAM J. Numer. Anal. 17(2).
    """

    dt: float
    method: Literal["linear", "pchip"] = "pchip"

    def __post_init__(self) -> None:
        if not 0 < self.dt < np.inf:
            raise RecordError(f"resample: dt is {self.dt:g} s, it must be positive")


def resampled(
    time: Array, signals: Sequence[Array], holds: Sequence[Hold | None], plan: Resample, where: str
) -> tuple[Array, list[Array], tuple[str, ...]]:
    """``signals``, each (n,) at ``time`` (n,), on the grid of ``plan``: its time (m,), the values, remarks.

    ``holds`` gives the hold of each input, and ``None`` for each other signal.

    Raises:
        RecordError: if a time stamp repeats or runs backward: no interpolation repairs that.
    """
    check_increasing(time, where)
    if len(time) < 2:
        raise RecordError(f"{where}: {len(time)} samples are too few to resample")
    # the last stamp belongs to the grid even if rounding puts it slightly beyond
    n = int(np.floor((time[-1] - time[0]) / plan.dt + 1e-6)) + 1
    grid = time[0] + plan.dt * np.arange(n)
    values = [
        _interpolated(grid, time, signal, hold, plan) for signal, hold in zip(signals, holds, strict=True)
    ]
    return grid, values, _remarks(time, plan, where)


def _interpolated(grid: Array, time: Array, signal: Array, hold: Hold | None, plan: Resample) -> Array:
    if hold == "zoh":
        return _step_means(grid, time, signal, plan.dt)
    inside = np.minimum(grid, time[-1])
    if plan.method == "linear":
        return np.interp(inside, time, signal)
    from scipy.interpolate import PchipInterpolator

    return PchipInterpolator(time, signal)(inside)


def _step_means(grid: Array, time: Array, signal: Array, dt: float) -> Array:
    """Mean of the staircase through ``signal`` over each step of the grid, from its integral."""
    widths = np.append(np.diff(time), 2 * dt)  # the last value is held beyond the last grid point
    integral = np.concatenate(([0.0], np.cumsum(signal * widths)))
    edges = np.append(grid, grid[-1] + dt)
    return np.diff(np.interp(edges, np.append(time, time[-1] + 2 * dt), integral)) / dt


def _remarks(time: Array, plan: Resample, where: str) -> tuple[str, ...]:
    steps = np.diff(time)
    usual, k = float(np.median(steps)), int(np.argmax(steps))
    remarks = [
        f"{where}: resampled onto an even grid of {plan.dt:g} s ({plan.method}; zoh inputs by their "
        f"mean over each step) from steps of {steps.min():.6g} to {steps.max():.6g} s"
    ]
    if steps[k] > GAP * usual:
        remarks.append(
            f"{where}: {steps[k]:.6g} s without a sample from t = {time[k]:g} s were filled by interpolation"
        )
    if plan.dt > COARSER * usual:
        remarks.append(
            f"{where}: resampling from {usual:.6g} s to {plan.dt:g} s folds high frequencies down; "
            f"resample to {usual:.3g} s and decimate instead"
        )
    return tuple(remarks)
