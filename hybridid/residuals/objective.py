"""What ``optimiser=lbfgs`` minimises: mean square error in free run, and the size of the weights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybridid.residuals.narx import Weights
from hybridid.residuals.recursion import gradient, simulate
from hybridid.residuals.samples import Samples
from hybridid.residuals.settings import Architecture
from hybridid.residuals.stretches import Stretches

Array = NDArray[np.float64]
Layers = tuple[Array, ...]


@dataclass(frozen=True, eq=False)
class Shape:
    """How the weights of a network lie in one vector.

    In order: weights of the past errors (lags, width), of the exogenous regressors (d, width), bias
    (width,); other hidden layers (depth - 1, width, width) and (depth - 1, width); output (width,) and (1,).
    The error is ``carry`` (0 or 1) times the last one plus ``gain`` times the output.
    """

    lags: int
    exogenous: int
    depth: int
    width: int
    carry: float
    gain: float

    @classmethod
    def of(cls, one: Architecture, gain: float) -> Shape:
        """Of a network; ``gain`` is the size of what it predicts, in multiples of the error's scale."""
        lags, carry = one.orders.error, float(one.increment)
        return cls(lags, one.orders.regressors - lags, one.depth, one.width, carry, gain)

    @cached_property
    def shapes(self) -> tuple[tuple[int, ...], ...]:
        """Of the parts, in order."""
        inner, width = self.depth - 1, self.width
        first = ((self.lags, width), (self.exogenous, width), (width,))
        return (*first, (inner, width, width), (inner, width), (width,), (1,))

    @cached_property
    def _edges(self) -> list[int]:
        return [0, *np.cumsum([int(np.prod(shape)) for shape in self.shapes]).tolist()]

    @property
    def count(self) -> int:
        """Number of weights and biases."""
        return self._edges[-1]

    def parts(self, flat: Array) -> Layers:
        """Views of the vector."""
        edges = self._edges
        return tuple(flat[a:b].reshape(s) for a, b, s in zip(edges, edges[1:], self.shapes, strict=False))

    def layers(self, flat: Array) -> Layers:
        """The parts, with the gain in the output."""
        *inner, output, offset = self.parts(flat)
        return (*inner, self.gain * output, self.gain * offset)

    def weights(self, flat: Array) -> Weights:
        """As a network holds them."""
        past, rows, bias, hidden, biases, output, offset = self.layers(flat)
        first = np.ascontiguousarray(np.vstack([past, rows]).T)
        inner = [np.ascontiguousarray(matrix.T) for matrix in hidden]
        return Weights((first, *inner, output[None].copy()), (bias.copy(), *biases.copy(), offset.copy()))

    def start(self, dice: np.random.Generator) -> Array:
        """Random weights (He et al. 2015); those of the output are a tenth, so that it is small at first."""
        flat = np.zeros(self.count)
        past, rows, _, hidden, _, output, _ = self.parts(flat)
        scale = (2.0 / self.width) ** 0.5
        first = (
            dice.normal(size=(self.lags + self.exogenous, self.width))
            * (2.0 / (len(past) + len(rows))) ** 0.5
        )
        past[:], rows[:] = first[: self.lags], first[self.lags :]
        hidden[:] = dice.normal(size=hidden.shape) * scale
        output[:] = dice.normal(size=output.shape) * scale * 0.1
        return flat


class FreeRun:
    """Mean square of the scaled error over free runs of ``stretches``; infinite if |e| exceeds ``limit``."""

    def __init__(self, shape: Shape, samples: Samples, stretches: Stretches, limit: float) -> None:
        self.shape, self.stretches, self.limit = shape, stretches, limit
        self._error, self._rows = samples.doubles
        self._found = np.zeros(len(self._error))
        self._seen = np.zeros((len(self._error), shape.lags))
        self._active = np.zeros((len(self._error), shape.depth, shape.width))
        self._counted = float(stretches.counts.sum())

    def __call__(self, flat: Array) -> float:
        """The mean square error of the network with these weights (n,)."""
        return self._square(self.shape.layers(flat))

    def with_gradient(self, flat: Array) -> tuple[float, Array]:
        """The same, and its gradient (n,); zeros where the network diverges."""
        shape, layers = self.shape, self.shape.layers(flat)
        square, slopes = self._square(layers), np.zeros_like(flat)
        if not np.isfinite(square):
            return square, slopes
        by_value = (2.0 / self._counted) * self.stretches.counts * (self._found - self._error)
        turned = (np.ascontiguousarray(layers[0].T), np.ascontiguousarray(layers[3].swapaxes(1, 2)))
        into = shape.parts(slopes)
        runs = self.stretches.runs
        gradient(layers, turned, self._rows, runs, shape.carry, self._seen, self._active, by_value, into)
        into[5][:] *= shape.gain
        into[6][:] *= shape.gain
        return square, slopes

    def _square(self, layers: Layers) -> float:
        one, shape = self.stretches, self.shape
        kept = (self._seen, self._active, self._found)
        if not simulate(layers, self._rows, one.runs, one.before, shape.carry, self.limit, *kept):
            return float("inf")
        return float((one.counts * (self._found - self._error) ** 2).sum() / self._counted)


def held_out(
    shape: Shape, samples: Samples, criterion: str, horizons: Sequence[int | None], limit: float
) -> FreeRun:
    """The error on the held-out blocks: in runs of the records from zero, or over windows (thesis)."""
    last = horizons[-1]
    if criterion == "free_run" or last is None:
        return FreeRun(shape, samples, Stretches.whole(samples, shape.lags, samples.split.held_out), limit)
    runs = [(int(k), int(k) + last) for k in samples.split.checks(last, samples.reach)]
    return FreeRun(shape, samples, Stretches.windows(samples, shape.lags, runs), float("inf"))
