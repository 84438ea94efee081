"""Training of a stack of networks on increasing horizons; each stops by its own held-out error."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.residuals.adam import Adam
from hybridid.residuals.criteria import Criterion
from hybridid.residuals.samples import Samples, Windows, gather
from hybridid.residuals.settings import Epoch, Training
from hybridid.residuals.stack import Stack

Index = NDArray[np.int64]


class Course:
    """Trains ``stack`` on ``samples`` (one for each network); ``best`` holds the best weights so far,
    ``score`` (b,) their held-out error by ``criterion``."""

    def __init__(
        self,
        stack: Stack,
        samples: Sequence[Samples],
        criterion: Criterion,
        settings: Training,
        seeds: Sequence[int],
    ) -> None:
        self.settings = settings
        self.samples = samples
        self.best = stack.part(range(len(samples)))
        self.history: list[list[Epoch]] = [[] for _ in samples]
        self.stopped: list[list[str]] = [[] for _ in samples]
        self._dice = [np.random.default_rng([seed, 1]) for seed in seeds]
        self._criterion = criterion
        self.score = criterion(self.best, range(len(samples)))

    def run(self, horizon: int, tell: Callable[[int, float], None]) -> None:
        """Train on one horizon from the best weights, until every network has stopped."""
        running = np.arange(len(self.samples))
        learner = _Learner.of(self.best.part(list(running)), self.settings)
        stale = np.zeros(len(running), dtype=int)
        for epoch in range(1, self.settings.epochs + 1):
            train = self._epoch(learner, running, horizon)
            held_out = self._criterion(learner.stack, list(running))
            better = held_out < self.score[running]
            self.best.put(list(running[better]), learner.stack.part(list(np.flatnonzero(better))))
            self.score[running[better]] = held_out[better]
            for k, network in enumerate(running):
                self.history[network].append(Epoch(horizon, float(train[k]), float(held_out[k])))
            tell(epoch, float(self.score.mean()))
            stale = np.where(better, 0, stale + 1)
            going = stale < self.settings.patience
            if not going.all():
                self._note(running[~going], f"no gain in {self.settings.patience} epochs", horizon, epoch)
                running, stale = running[going], stale[going]
                if not len(running):
                    return
                learner = learner.part(np.flatnonzero(going))
        self._note(running, "all epochs used", horizon, self.settings.epochs)

    def _epoch(self, learner: _Learner, running: Index, horizon: int) -> NDArray[np.float64]:
        """One pass over the training blocks; returns each network's mean loss (b,)."""
        samples = [self.samples[k] for k in running]
        windows = max(1, self.settings.batch // horizon)
        steps = -(-samples[0].trained_on // (windows * horizon))
        order = [self._order(k, horizon, steps * windows) for k in running]
        losses = []
        for step in range(steps):
            part = slice(step * windows, (step + 1) * windows)
            losses.append(
                learner.step(gather(samples, [o[part] for o in order], horizon, learner.stack.lags))
            )
        return np.mean(losses, axis=0)

    def _order(self, network: int, horizon: int, count: int) -> Index:
        """First samples of ``count`` windows, in the network's own random order."""
        sample = self.samples[network]
        return np.resize(self._dice[network].permutation(sample.split.starts(horizon, sample.reach)), count)

    def _note(self, networks: Index, why: str, horizon: int, epoch: int) -> None:
        for k in networks:
            self.stopped[k].append(f"horizon {horizon}: {why}, {epoch} epochs")


@dataclass(frozen=True)
class _Learner:
    """A stack and its optimiser."""

    stack: Stack
    adam: Adam

    @classmethod
    def of(cls, stack: Stack, settings: Training) -> _Learner:
        return cls(stack, Adam(stack.tensors, settings.learning_rate, settings.weight_decay))

    def step(self, windows: Windows) -> NDArray[np.float64]:
        """One optimiser step on each network's own loss; returns the losses (b,)."""
        self.adam.forget()
        losses = (self.stack(windows.past, windows.rows) - windows.target).square().mean(dim=(1, 2))
        losses.sum().backward()
        self.stack.cut_gradients()
        self.adam.step()
        return losses.detach().double().numpy()

    def part(self, chosen: Index) -> _Learner:
        """The learner of these networks only, with their moments."""
        rows = list(chosen)
        smaller = self.stack.part(rows)
        return _Learner(smaller, self.adam.part(rows, smaller.tensors))
