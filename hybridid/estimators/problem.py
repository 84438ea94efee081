"""``Problem``: the weighted least-squares problem that every estimator here solves.

``min over p, x0 of 1/2 sum ((y - y_hat(p, x0)) / s)^2`` over all horizons, with s (n_y,)
the noise of each output's sensor, where each is declared, else the standard deviation of each output over the
records. With s the noise this is maximum likelihood for white noise. Source: Ljung (1999), System
Identification, 2nd ed., sec. 7.4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.naming import listed
from hybridid.records.record import Record
from hybridid.simulation.initial import measured_states
from hybridid.simulation.matching import check_records
from hybridid.simulation.shooter import Shooter, Shot
from hybridid.simulation.windows import Windows, cut

Array = NDArray[np.float64]
EXACT = 1e-10
"""Residual over the output's standard deviation that is the arithmetic's own."""
MOST = 1500
"""Initial states up to which normal equations of all of them pay, where horizons hand inner states on."""
ROUNDING = 1e-9
"""Share of a cost that the order of its sum cannot change."""


@dataclass(frozen=True)
class Problem:
    """Model, data and what may move. ``estimate_x0`` False keeps the measured initial states. ``weights``
    (w, H, n_y) multiply the residuals (None: 1)."""

    model: Model
    records: tuple[Record, ...]
    windows: Windows
    shooter: Shooter
    scale: Array
    estimate_x0: bool
    weights: Array | None = None

    @property
    def free(self) -> tuple[str, ...]:
        """Qualified names of the free parameters, in the order of the sensitivities."""
        return self.shooter.free

    @property
    def positions(self) -> list[int]:
        """Places of the free parameters in the parameter vector."""
        names = [p.name for p in self.model.parameters]
        return [names.index(name) for name in self.free]

    @cached_property
    def moving(self) -> NDArray[np.bool_]:
        """Which initial states (w, n_x) are estimated.

        The plant's, and those of an effect that an output shows; an effect's inner states are
        carried from horizon to horizon instead (``hybridid.estimators.carried``).
        """
        return np.tile(~self.carried & self.estimate_x0, (self.windows.count, 1))

    @cached_property
    def carried(self) -> NDArray[np.bool_]:
        """Which states (n_x,) horizons hand on: an effect's own that no output shows."""
        return np.isin(np.arange(len(self.model.states)), self.shooter.carried)

    def measured_x0(self) -> Array:
        """Initial state of each horizon as the record shows it, (w, n_x)."""
        return np.stack([self._measured[index][start] for index, start, _ in self.windows.origin])

    @cached_property
    def _measured(self) -> list[Array]:
        """States of each record's samples as it shows them, (n, n_x)."""
        return [measured_states(self.model, record) for record in self.records]

    @cached_property
    def hands_on(self) -> bool:
        """Whether a horizon takes over inner states from another."""
        return bool(self.carried.any()) and max(self.windows.follows) >= 0

    @cached_property
    def couples(self) -> bool:
        """Whether it does, and the initial states that are estimated are few enough for equations of all."""
        return self.hands_on and bool(self.moving.any()) and self.moving.size <= MOST

    def shot(self, x0: Array, p: Array, sensitivities: bool, limit: float = np.inf) -> Shot:
        """A simulation from ``x0`` (w, n_x) at ``p`` (n_p,) for a descent, with ``sensitivities`` as far as
        its normal equations need them. It may end where its cost is above ``limit``; it is infinite then."""
        if sensitivities and self.hands_on and not self.couples:
            return self.shooter(x0, p, sensitivities)
        room = 2 * (1 + ROUNDING) * limit
        return self.shooter.compared(x0, p, self._factors, sensitivities, room)

    @cached_property
    def _factors(self) -> Array:
        """What the outputs' errors are multiplied by, (w, H, n_y): 0 where an output does not count."""
        factors = self.windows.cells / self.scale
        return factors if self.weights is None else factors * self.weights

    def finer_outputs(self, x0: Array, p: Array) -> Array:
        """Outputs (w, H, n_y) of a simulation from ``x0`` (w, n_x) at ``p`` (n_p,) in steps of half the
        length. The last ones are kept: a fit asks for those of its solution twice."""
        kept = self._kept_finer
        if not kept or not (np.array_equal(kept[0], x0) and np.array_equal(kept[1], p)):
            kept[:] = [np.array(x0), np.array(p), self._finer(x0, p).outputs]
        return kept[2]

    @cached_property
    def _kept_finer(self) -> list[Array]:
        return []

    @cached_property
    def _finer(self) -> Shooter:
        """It simulates in steps of half the length."""
        return self.shooter.over(cut(self.records, self.windows.horizon, 2 * self.windows.substeps))

    def residuals(self, shot: Shot) -> Array:
        """``(y - y_hat) / s``, zero where an output does not count; shape (w, H, n_y)."""
        error = (self.windows.outputs - shot.outputs) / self.scale
        if self.weights is not None:
            error = error * self.weights
        return np.where(self.windows.cells, error, 0.0)

    def moved_by_half_the_step(self, x0: Array, p: Array) -> tuple[Array, Array]:
        """The residuals (w, H, n_y) at ``x0`` (w, n_x) and ``p`` (n_p,), and by how much steps of half the
        length change them."""
        shot = self.shooter(x0, p)
        left = self.residuals(shot)
        return left, left - self.residuals(replace(shot, outputs=self.finer_outputs(x0, p)))

    def cost(self, shot: Shot) -> float:
        """Half the sum of squared residuals; infinite if the simulation diverged."""
        r = None if shot.compared else self.residuals(shot)
        with np.errstate(over="ignore", invalid="ignore"):
            total = 0.5 * float(np.sum(shot.spent if r is None else r * r))
        return total if np.isfinite(total) else np.inf

    def costs(self, shot: Shot) -> Array:
        """The cost of each horizon, (w,); infinite where the simulation diverged."""
        r = None if shot.compared else self.residuals(shot)
        with np.errstate(over="ignore", invalid="ignore"):
            each = 0.5 * (shot.spent if r is None else np.sum(r * r, axis=(1, 2)))
        return np.where(np.isfinite(each), each, np.inf)

    @cached_property
    def rounding(self) -> float:
        """A cost that the arithmetic alone leaves."""
        return 0.5 * EXACT**2 * self.windows.samples * len(self.scale)

    def smoothed(self, p: Array, factor: float) -> Array:
        """``p`` with every declared smoothing width (not estimated) times ``factor``, to the power that it
        ``smooths``."""
        q = np.array(p)
        for k in self.widths:
            width = self.model.parameters[k]
            q[k] = width.guess * factor**width.smooths
        return q

    @property
    def widths(self) -> list[int]:
        """Places of the smoothing widths in the parameter vector."""
        return [k for k, q in enumerate(self.model.parameters) if q.fixed and q.smooths]

    def on(self, horizons: Sequence[int]) -> Problem:
        """The same problem on some of its horizons, by number."""
        weights = None if self.weights is None else self.weights[list(horizons)]
        return replace(self._over(self.windows.select(horizons)), weights=weights)

    def without_ends(self, gap: int) -> Problem:
        """The same problem with the last ``gap`` samples of each horizon left out."""
        return self._over(self.windows.without_ends(gap))

    def in_steps(self, substeps: int) -> Problem:
        """The same problem simulated in ``substeps`` steps a sample."""
        return self._over(self.windows.in_steps(self.records, substeps))

    def _over(self, windows: Windows) -> Problem:
        return replace(self, windows=windows, shooter=self.shooter.over(windows))

    def estimating(self, free: Sequence[str]) -> Problem:
        """The same problem with other parameters free."""
        return replace(self, shooter=replace(self.shooter, free=tuple(free)))


def build_problem(
    model: Model,
    records: Sequence[Record],
    horizon: int | None,
    substeps: int,
    estimate_x0: bool = True,
    free: Sequence[str] | None = None,
    integrator: str = "rk4",
) -> Problem:
    """The least-squares problem of ``model`` on ``records``; ``free`` defaults to all not fixed.

    Raises:
        ValueError: if a record's inputs or outputs are not the model's.
    """
    check_records(model, records)
    windows = cut(records, horizon, substeps)
    names = tuple(p.name for p in model.free) if free is None else tuple(free)
    scale = output_scale(records)
    shooter = Shooter(model, windows, names, integrator, _inner(model))
    return Problem(model, tuple(records), windows, shooter, scale, estimate_x0)


def output_scale(records: Sequence[Record]) -> Array:
    """What the errors of each output are divided by, (n_y,): see the head of this file.

    Raises:
        ValueError: if the noise of some outputs is declared, and that of others is not.
    """
    noise = np.array([[channel.noise for channel in record.output_channels] for record in records])
    if noise.all():
        return np.sqrt(np.mean(noise**2, axis=0))
    if noise.any():
        names = [channel.name for channel in records[0].output_channels]
        without = listed([name for k, name in enumerate(names) if not noise[:, k].all()])
        raise ValueError(
            f"noise is declared for some outputs, but not for {without}: give it for each or none"
        )
    scale = np.nanstd(np.concatenate([record.counted for record in records]), axis=0)
    return np.where(scale == 0, 1.0, scale)


def _inner(model: Model) -> tuple[int, ...]:
    """Places of the states of effects that no output shows."""
    first = len(model.plant.states)
    return tuple(k for k, s in enumerate(model.states) if k >= first and s.observed_by is None)


def paths(problem: Problem, p: Array, x0: Array) -> list[Array]:
    """States (n, n_x) of each record's samples, as the horizons run through them."""
    states = problem.shooter(x0, p).states
    found = [np.zeros((record.n, states.shape[2])) for record in problem.records]
    for run, (record, start, stop) in zip(states, problem.windows.origin, strict=True):
        found[record][start:stop] = np.where(np.isfinite(run), run, 0.0)[: stop - start]
    return found
