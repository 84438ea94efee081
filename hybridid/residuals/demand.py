"""What the training of NARX networks needs, from their sizes alone. Light: it does not load torch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hybridid.demand import Demand
from hybridid.residuals.settings import PAIRS, SMALL, Architecture, Training

_ITEM: Mapping[str, int] = {"single": 4, "double": 8}
_BASE = 1e8
"""Bytes that torch and the compiled free run take by themselves."""
_STEP = 1e-4
"""Seconds that a step of the training takes at least, however small the network."""
_FLOPS = 2e10
"""Operations a second at most."""
_READ = 1e10
"""Bytes a second at most that a free run reads: it needs all weights at each sample."""


def training_demand(
    architectures: Sequence[Architecture], copies: int, samples: int, training: Training
) -> Demand:
    """Of ``copies`` networks of each size, on errors of ``samples`` samples in all records.

    Small networks train in one stack, each larger size in one of its own, one after the other. With lbfgs,
    each network trains alone.
    """
    parts: list[_Stack | _Alone]
    if training.optimiser == "lbfgs":
        parts = [_Alone(one, copies, samples, training) for one in architectures]
    else:
        stacks: dict[tuple[int, int] | None, list[Architecture]] = {}
        for one in architectures:
            stacks.setdefault(stack_of(one), []).extend([one] * copies)
        parts = [_Stack(tuple(own), samples, training) for own in stacks.values()]
    count = len(architectures) * copies
    return Demand(
        f"the training of {count} network{'s' * (count > 1)}",
        _BASE + max(part.memory for part in parts),
        sum(part.seconds for part in parts),
        max(parts, key=lambda part: part.memory).keys,
    )


_SETTLES = 20
"""Epochs that a descent of lbfgs takes at least, however soon it has converged."""


@dataclass(frozen=True)
class _Alone:
    """Networks of one size that train one after another, with lbfgs."""

    network: Architecture
    copies: int
    samples: int
    training: Training

    @property
    def weights(self) -> float:
        """Of one network."""
        one = self.network
        return (one.orders.regressors + 2 + (one.depth - 1) * (one.width + 1)) * one.width + 1

    @property
    def memory(self) -> float:
        """Bytes: the pairs of steps that the method remembers, three times over in its own work; the neurons
        and regressors of each sample, for the training and for the held-out error."""
        one, grid = self.network, self.samples / self.network.every
        return 8 * (
            6 * PAIRS * self.weights + 2 * grid * (one.depth * one.width + 2 * one.orders.regressors + 8)
        )

    @property
    def seconds(self) -> float:
        """At least: a descent from each start on each horizon."""
        training = self.training
        descents = training.starts * len(training.horizons)
        epochs = min(training.epochs, training.patience, _SETTLES)
        each = 6 * self.samples / self.network.every * self.weights / _FLOPS
        return self.copies * descents * epochs * each

    @property
    def keys(self) -> tuple[str, ...]:
        """The setting that is furthest from what is usual."""
        one = self.network
        times = {
            f"residual.width ({one.width})": one.width / 100,
            f"residual.depth ({one.depth})": one.depth / 10,
            f"residual.orders ({one.orders.longest})": one.orders.longest / 100,
            f"residual.starts ({self.training.starts})": self.training.starts / 10,
            "residual.optimiser (lbfgs), on so many samples": self.samples / 100_000,
        }
        return (max(times, key=lambda name: times[name]),)


@dataclass(frozen=True)
class _Stack:
    """Networks that train together, padded to the largest."""

    networks: tuple[Architecture, ...]
    samples: int
    training: Training

    @property
    def weights(self) -> float:
        """Of all networks with their padding."""
        inner = (self.depth - 1) * (self.width + 1) * self.width
        return len(self.networks) * ((self.regressors + 1) * self.width + inner + self.width + 1)

    @property
    def memory(self) -> float:
        """Bytes: eight copies of the weights in training (best, gradients, moments, in passing) and two in
        double precision for the free run; what a step keeps for its gradients; regressors of each sample."""
        item, batch = _ITEM[self.training.precision], self._windows * self.training.windows[-1]
        kept = 1.5 * len(self.networks) * batch * (2 * self.depth * self.width + self.regressors) * item
        return self.weights * (8 * item + 16) + kept + 4 * self._grid * (self.regressors + 2) * (item + 8)

    @property
    def seconds(self) -> float:
        """At least: every horizon trains until ``patience`` epochs have brought nothing."""
        training = self.training
        epochs = min(training.epochs, training.patience)
        trained = self._grid * (1 - training.held_out)
        found = 0.0
        for horizon in training.windows:
            steps = max(1.0, trained / (max(1, training.batch // horizon) * horizon))
            once = 6 * trained * self.weights / _FLOPS + 8 * self._grid * self.weights / _READ
            found += epochs * (once + steps * horizon * self.depth * _STEP)
        return found

    @property
    def keys(self) -> tuple[str, ...]:
        """The setting that is furthest from what is usual."""
        training, orders = self.training, max(one.orders.longest for one in self.networks)
        times = {
            f"residual.width ({self.width})": self.width / 100,
            f"residual.depth ({self.depth})": self.depth / 10,
            f"residual.orders ({orders})": orders / 100,
            f"residual.batch ({training.batch})": training.batch / 10_000,
            f"residual.epochs ({training.epochs})": min(training.epochs, training.patience) / 1000,
            f"the number of networks ({len(self.networks)})": len(self.networks) / 100,
        }
        return (max(times, key=lambda name: times[name]),)

    @property
    def width(self) -> int:
        return max(one.width for one in self.networks)

    @property
    def depth(self) -> int:
        return max(one.depth for one in self.networks)

    @property
    def regressors(self) -> int:
        return max(one.orders.regressors for one in self.networks)

    @property
    def _grid(self) -> float:
        return self.samples / self.networks[0].every

    @property
    def _windows(self) -> int:
        return max(1, self.training.batch // self.training.windows[-1])


def stack_of(one: Architecture) -> tuple[int, int] | None:
    """Which networks train together: None for all small ones, else those of the same depth and width."""
    return None if one.width <= SMALL else (one.depth, one.width)
