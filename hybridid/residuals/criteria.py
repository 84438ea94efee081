"""The error on held-out blocks, which decides when training stops."""

from __future__ import annotations

import abc
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from hybridid.residuals.narx import Weights, scaled_run
from hybridid.residuals.samples import Samples, Windows, gather
from hybridid.residuals.stack import Stack

Array = NDArray[np.float64]


class Criterion(abc.ABC):
    """Mean square error on the held-out blocks over that without a network; infinite if it diverges."""

    @abc.abstractmethod
    def __call__(self, stack: Stack, networks: Sequence[int]) -> Array:
        """Value of each network of ``stack``, (b,); their indices are ``networks``."""


@dataclass(frozen=True, eq=False)
class HorizonError(Criterion):
    """Error over adjacent windows, each simulated from measured past errors."""

    windows: Windows

    @classmethod
    def of(cls, samples: Sequence[Samples], horizon: int, lags: int) -> HorizonError:
        """The criterion over held-out windows of ``horizon`` grid samples, with ``lags`` past errors each."""
        starts = [s.split.checks(horizon, s.reach) for s in samples]
        return cls(gather(samples, starts, horizon, lags))

    def __call__(self, stack: Stack, networks: Sequence[int]) -> Array:
        windows = self.windows.of(networks)
        with torch.no_grad():
            squares = (stack(windows.past, windows.rows) - windows.target).double().square().mean(dim=2)
        found = ((squares * windows.weight).sum(dim=1) / windows.weight.sum(dim=1)).numpy()
        return np.where(np.isfinite(found), found, np.inf)


@dataclass(frozen=True, eq=False)
class FreeRunError(Criterion):
    """Error of a simulation of each whole record from zero; ``limits`` (b,) bound the scaled |error|."""

    samples: Sequence[Samples]
    limits: Sequence[float]

    def __call__(self, stack: Stack, networks: Sequence[int]) -> Array:
        weights = stack.padded_weights()
        pairs = zip(weights, networks, strict=True)
        return np.array([self.of([one], k, stack.lags, stack.carry) for one, k in pairs])

    def of(self, members: Sequence[Weights], network: int, lags: int, carry: float) -> float:
        """Value of one network with these members, which sees ``lags`` past errors; ``carry``: 0 or 1."""
        sample, limit, begin = self.samples[network], self.limits[network], np.zeros(lags)
        error, rows = sample.doubles
        runs = [scaled_run(members, rows[a:b], begin, carry, limit)[0] for a, b in sample.pieces]
        square = float(np.mean((np.concatenate(runs) - error)[sample.held_out] ** 2))
        return square if np.isfinite(square) else np.inf


def without_correction(sample: Samples) -> float:
    """Mean square of the scaled error on the held-out blocks, without a network."""
    return float(np.mean(sample.doubles[0][sample.held_out] ** 2))
