"""``optimiser=lbfgs``: a network trained on all samples at once, from several starts.

For a network of some hundred weights on a record of some thousand samples, one pass with its gradient takes a
millisecond. A quasi-Newton method then reaches the optimum of its objective, where a descent in small random
steps stops somewhere on the way, each seed elsewhere. The method is SciPy's L-BFGS-B. Source: Liu, Nocedal
(1989), Math. Programming 45, 503-528; Byrd, Lu, Nocedal, Zhu (1995), SIAM J. Sci. Comput. 16, 1190-1208.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybridid.residuals.narx import Weights
from hybridid.residuals.objective import FreeRun, Shape, held_out
from hybridid.residuals.samples import Samples
from hybridid.residuals.settings import PAIRS, Architecture, Epoch, Training
from hybridid.residuals.stretches import training

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

Array = NDArray[np.float64]
Tell = Callable[[int | None, int, float, float], None]
"""Is told the horizon, the epoch, the held-out error, and which share of all is done."""
SETTLED = 1e-9
"""Relative decrease of the objective in one step that counts as none."""
LOOK = 10
"""Epochs between two looks at the held-out error: each costs a third of an epoch."""
VANISHED = 0.95
"""A start whose objective is above this share of no network's has learned nothing."""
FAR = 1e10
"""The objective where a network diverges: large, but finite, so that the line search can step back."""


@dataclass(frozen=True, eq=False)
class Descended:
    """A network after its training: the members to keep, and how the first of them came about."""

    members: tuple[Weights, ...]
    history: tuple[Epoch, ...]
    stopped: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class _Way:
    """Where a network has come to: its weights, and why the training on each horizon ended."""

    flat: Array
    objective: float = float("inf")
    history: tuple[Epoch, ...] = ()
    stopped: tuple[str, ...] = ()


class Descent:
    """The training of one network; it has diverged where the scaled |e| exceeds ``limit``."""

    def __init__(
        self, one: Architecture, samples: Samples, settings: Training, gain: float, limit: float
    ) -> None:
        self.shape = Shape.of(one, gain)
        self.samples, self.settings, self.limit = samples, settings, limit
        self._held_out = held_out(self.shape, samples, settings.criterion, settings.horizons, limit)

    def run(self, seed: int, tell: Tell) -> Descended:
        """Train every start on all horizons. The network is their mean, without those that have vanished or
        diverged."""
        horizons, starts = self.settings.horizons, self.settings.starts
        steps, errors = _Steps(self.settings, starts * len(horizons), tell), list(map(self._error, horizons))
        ways = [_Way(self.shape.start(np.random.default_rng([seed, k]))) for k in range(starts)]
        for horizon, error in zip(horizons, errors, strict=True):
            ways = [self._go_on(way, error, horizon, steps) for way in ways]
        nothing = errors[-1](np.zeros(self.shape.count))
        best, *others = sorted(ways, key=lambda way: way.objective)
        kept = (best, *(way for way in others if way.objective < VANISHED * nothing))
        return Descended(tuple(self.shape.weights(way.flat) for way in kept), best.history, best.stopped)

    def _error(self, horizon: int | None) -> FreeRun:
        stretches = training(self.samples, self.shape.lags, horizon)
        return FreeRun(self.shape, self.samples, stretches, self.limit)

    def _go_on(self, way: _Way, error: FreeRun, horizon: int | None, steps: _Steps) -> _Way:
        """One horizon: to the optimum of the objective, or until the held-out error no longer decreases."""
        watch = _Watch(self._held_out, horizon, self.settings, steps)
        from scipy.optimize import minimize

        decay, most = self.settings.weight_decay, self.settings.epochs

        def objective(flat: Array) -> tuple[float, Array]:
            square, slopes = error.with_gradient(flat)
            if not np.isfinite(square):
                return FAR, slopes
            return square + 0.5 * decay * float(flat @ flat), slopes + decay * flat

        options = {"maxiter": most, "maxfun": 4 * most + 20, "maxcor": PAIRS, "ftol": SETTLED, "gtol": 1e-9}
        found = minimize(objective, way.flat, jac=True, method="L-BFGS-B", options=options, callback=watch)
        flat = found.x if watch.best is None else watch.best
        steps.done += 1
        stopped = (*way.stopped, watch.why(found.nit, found.nit >= most))
        return _Way(flat, float(found.fun), (*way.history, *watch.history), stopped)


@dataclass
class _Steps:
    """How much of a training is done, in descents of ``count``."""

    settings: Training
    count: int
    tell: Tell
    done: int = 0

    def report(self, horizon: int | None, epoch: int, held_out: float) -> None:
        """Tell it."""
        share = (self.done + min(epoch / self.settings.epochs, 1.0)) / self.count
        self.tell(horizon, epoch, held_out, share)


class _Watch:
    """Follows a descent on ``horizon``: looks at the held-out error every ``LOOK`` epochs.

    ``best`` are the weights that had the lowest, if the held-out error ended the descent, else None.
    """

    def __init__(self, criterion: FreeRun, horizon: int | None, settings: Training, steps: _Steps) -> None:
        self._criterion, self._horizon, self._settings, self._steps = criterion, horizon, settings, steps
        self.best: Array | None = None
        self.history: list[Epoch] = []
        self._epoch, self._lowest, self._lowest_at, self._reached = 0, float("inf"), 0, np.empty(0)

    def __call__(self, intermediate_result: OptimizeResult) -> None:
        """SciPy calls this after each step.

        Raises:
            StopIteration: if the held-out error has not decreased for ``patience`` epochs.
        """
        self._epoch += 1
        if self._epoch % min(LOOK, self._settings.patience):
            return
        settings, flat = self._settings, np.array(intermediate_result.x)
        square = self._criterion(flat)
        train = float(intermediate_result.fun) - 0.5 * settings.weight_decay * float(flat @ flat)
        self.history.append(Epoch(self._horizon, train, square))
        if square < self._lowest or not len(self._reached):
            self._lowest, self._lowest_at, self._reached = square, self._epoch, flat
        self._steps.report(self._horizon, self._epoch, self._lowest)
        if self._epoch - self._lowest_at >= settings.patience:
            self.best = self._reached
            raise StopIteration

    def why(self, epochs: int, all_used: bool) -> str:
        """What ended the descent."""
        length = "whole record" if self._horizon is None else f"horizon {self._horizon}"
        ended = "all epochs used" if all_used else "converged"
        if self.best is not None:
            ended = f"no gain in {self._settings.patience} epochs"
        return f"{length}: {ended}, {epochs} epochs"
