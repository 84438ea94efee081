"""Resampling onto an even time grid, when a user asks for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from hybridid.records.channel import Array, Hold, RecordError
from hybridid.records.checks import GAP, check_increasing, leave_out

COARSER = 1.5  # of the usual step; a longer new step without a filter causes aliasing
KEPT = (2.0 / 3.0) ** 0.5
"""Share of a white error that a line between two samples keeps, root mean square over its length."""


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
    time: Array,
    signals: Sequence[Array],
    holds: Sequence[Hold | None],
    plan: Resample,
    where: str,
    stamps: Sequence[Array] | None = None,
) -> tuple[Array, list[Array], tuple[str, ...]]:
    """``signals``, each (n,) at ``time`` (n,), on the grid of ``plan``: its time (m,), the values, remarks.

    ``holds`` gives the hold of each input, and ``None`` for each other signal. ``stamps`` are the times of
    each signal where they are not ``time``; the grid then covers what all have in common.

    Raises:
        RecordError: if a time stamp repeats or runs backward, which no interpolation repairs, or if the times
            of the signals have none in common.
    """
    own = [time] * len(signals) if stamps is None else list(stamps)
    for one in (time, *([] if stamps is None else own)):
        check_increasing(one, where)
        if len(one) < 2:
            raise RecordError(f"{where}: {len(one)} samples are too few to resample")
    first, last = _in_common(time, own, holds, where)
    # the last stamp belongs to the grid even if rounding puts it slightly beyond
    n = int(np.floor((last - first) / plan.dt + 1e-6)) + 1
    grid = np.asarray(first + plan.dt * np.arange(n), dtype=float)
    values = [
        _interpolated(grid, at, signal, hold, plan)
        for at, signal, hold in zip(own, signals, holds, strict=True)
    ]
    return grid, values, _remarks(time, plan, where)


def _in_common(
    time: Array, own: Sequence[Array], holds: Sequence[Hold | None], where: str
) -> tuple[float, float]:
    """From when to when ``time`` and all signals have values; a held one keeps its last."""
    first = float(max([time[0], *(at[0] for at in own)]))
    last = float(min([time[-1], *(at[-1] for at, hold in zip(own, holds, strict=True) if hold != "zoh")]))
    if not first < last:
        raise RecordError(
            f"{where}: its signals have no time in common: one begins at {first:g} s, another ends at "
            f"{last:g} s"
        )
    return first, last


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
    # the last value is held beyond the last grid point, which may be long after the last of its own stamps
    beyond = 2 * dt + (grid[-1] - time[-1] if grid[-1] > time[-1] + dt else 0.0)
    widths = np.append(np.diff(time), beyond)
    level = signal[0]  # what stands still stays still, to the last digit
    integral = np.concatenate(([0.0], np.cumsum((signal - level) * widths)))
    edges = np.append(grid, grid[-1] + dt)
    return level + np.diff(np.interp(edges, np.append(time, time[-1] + beyond), integral)) / dt


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
            f"; {leave_out(where.removeprefix('record '), time[k], time[k + 1])} leaves them out"
        )
    if plan.dt > COARSER * usual:
        remarks.append(
            f"{where}: resampling from {usual:.6g} s to {plan.dt:g} s folds high frequencies down; "
            f"resample to {usual:.3g} s and decimate instead"
        )
    return tuple(remarks)
