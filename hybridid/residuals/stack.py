"""Many networks trained together: the weights of every layer have a leading network axis.

A training step of a small network takes mostly the overhead of its function calls. A stack of networks needs
the same number of calls, so it takes hardly longer than one. Networks with fewer regressors are padded: a
mask removes the additional ones and their gradients. Narrower networks are padded with neurons of zero
weights: such a neuron gives elu(0) = 0 into weights of zero, so its gradient is zero. Shallower networks
skip the layers that they lack.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from hybridid.residuals.narx import Weights
from hybridid.residuals.settings import Architecture

Array = NDArray[np.float64]
LARGEST_GRADIENT = 1.0
"""Largest norm of each network's gradient: back through many steps, a gradient can explode."""

DTYPES = {"single": torch.float32, "double": torch.float64}


@contextmanager
def one_thread() -> Iterator[None]:
    """Use one thread in torch: small networks do not gain from more, and workers share a machine."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


class Stack:
    """``b`` networks: layers ``(b, n_in, n_out)`` and ``(b, 1, n_out)``; the first looks at ``lags``
    past errors and then at exogenous regressors, by ``mask`` (b, n_in, 1). ``sizes`` are each network's
    own depth and width. The error is ``carry`` (0 or 1) times the last one plus ``gain`` (b, 1, 1) times
    what the last layer gives."""

    def __init__(
        self,
        layers: Sequence[tuple[Tensor, Tensor]],
        sizes: Sequence[tuple[int, int]],
        mask: Tensor,
        lags: int,
        carry: float,
        gain: Tensor,
    ) -> None:
        self.layers = [tuple(t.detach().clone().requires_grad_() for t in layer) for layer in layers]
        self.sizes = tuple(sizes)
        depths = torch.tensor([depth for depth, _ in sizes])[:, None, None]
        # a layer that every network has needs no selection
        self._owners = [
            None if bool((depths > k).all()) else depths > k for k in range(1, len(self.layers) - 1)
        ]
        self.mask = mask
        self.lags = lags
        self.carry = carry
        self.gain = gain
        self._scaled = bool((gain != 1.0).any())

    @property
    def tensors(self) -> list[Tensor]:
        """Weights and biases of all layers, in order: the tensors that training changes."""
        return [tensor for layer in self.layers for tensor in layer]

    def __call__(self, past: Tensor, rows: Tensor) -> Tensor:
        """Free-run predictions (b, w, h) from ``past`` errors (b, w, lags), the newest first, and
        exogenous regressors ``rows`` (b, w, h, d)."""
        (first, bias), *inner, (last, offset) = self.layers
        first = first * self.mask
        b, windows, horizon, _ = rows.shape
        by_past = first[:, : self.lags]
        driven = torch.baddbmm(bias, rows.flatten(1, 2), first[:, self.lags :]).view(b, windows, horizon, -1)
        found = []
        for drive in driven.unbind(2):  # slices would need horizon² memory in the backward pass
            x = torch.nn.functional.elu(torch.baddbmm(drive, past, by_past))
            for (matrix, shift), owners in zip(inner, self._owners, strict=True):
                y = torch.nn.functional.elu(torch.baddbmm(shift, x, matrix))
                x = y if owners is None else torch.where(owners, y, x)
            value = torch.baddbmm(offset, x, last)
            value = self.gain * value if self._scaled else value
            if self.carry:
                value = value + self.carry * past[:, :, :1]
            found.append(value)
            past = torch.cat([value, past[:, :, :-1]], dim=2) if self.lags else past
        return torch.cat(found, dim=2)

    def cut_gradients(self) -> None:
        """Limit each network's gradient norm to ``LARGEST_GRADIENT``; one that is not finite becomes zero."""
        gradients = [t.grad for t in self.tensors if t.grad is not None]
        squares = torch.stack([g.square().sum(dim=(1, 2)) for g in gradients]).sum(dim=0)
        norm = squares.sqrt()
        factor = (
            (LARGEST_GRADIENT / (norm + 1e-12)).clamp(max=1.0).where(norm.isfinite(), torch.zeros_like(norm))
        )
        for g in gradients:
            g.mul_(factor[:, None, None]).nan_to_num_(0.0, 0.0, 0.0)

    def part(self, chosen: Sequence[int]) -> Stack:
        """The networks with these indices, as a stack of their own."""
        rows = list(chosen)
        layers = [(w[rows], b[rows]) for w, b in self.layers]
        sizes = [self.sizes[k] for k in rows]
        return Stack(layers, sizes, self.mask[rows], self.lags, self.carry, self.gain[rows])

    def put(self, chosen: Sequence[int], other: Stack) -> None:
        """Copy the weights of ``other``'s networks to those with the indices ``chosen``."""
        rows = list(chosen)
        with torch.no_grad():
            for mine, theirs in zip(self.tensors, other.tensors, strict=True):
                mine[rows] = theirs

    def weights(self, index: int) -> Weights:
        """One network's weights as float64, without the masked regressors."""
        seen = self.mask[index, :, 0].bool().numpy()
        return self.part([index]).padded_weights()[0].seeing(seen)

    def padded_weights(self) -> list[Weights]:
        """Every network's weights as float64, zero for the masked regressors."""
        with torch.no_grad():
            (first, bias), *inner, (last, offset) = self.layers
            layers = [(first * self.mask, bias), *inner, (self.gain * last, self.gain * offset)]
            arrays = [(w.double().swapaxes(1, 2).numpy(), b.double()[:, 0].numpy()) for w, b in layers]
        return [_cut(arrays, k, depth, width) for k, (depth, width) in enumerate(self.sizes)]


def _cut(arrays: Sequence[tuple[Array, Array]], k: int, depth: int, width: int) -> Weights:
    """Network ``k`` of a stack's layers, (b, n_out, n_in) and (b, n_out), of its own depth and width."""
    (first, bias), *inner = [(w[k], b[k]) for w, b in arrays[:depth]]
    last, offset = arrays[-1][0][k], arrays[-1][1][k]
    matrices = [first[:width], *(w[:width, :width] for w, _ in inner), last[:, :width]]
    shifts = [bias[:width], *(b[:width] for _, b in inner)]
    return Weights(tuple(map(np.ascontiguousarray, matrices)), (*(s.copy() for s in shifts), offset.copy()))


def new_stack(
    architectures: Sequence[Architecture], seeds: Sequence[int], gains: Sequence[float], precision: str
) -> Stack:
    """Untrained networks; each one's weights depend only on its own architecture and seed.

    ``gains`` are the magnitudes of the quantities to predict, in multiples of the error's scale.

    He initialisation; the last layer is a tenth of it, so that the initial output is small.
    Source: He, Zhang, Ren, Sun (2015), ICCV, 1026-1034.

    Raises:
        ValueError: if increment or the number of inputs differ.
    """
    one = architectures[0]
    for other in architectures:
        if other.increment != one.increment:
            raise ValueError("networks of one stack share residual.increment")
        if len(other.orders.inputs) != len(one.orders.inputs):
            raise ValueError("networks of one stack share their inputs")
    lags = max(a.orders.error for a in architectures)
    mask = torch.stack([_mask(a, architectures) for a in architectures])[..., None]
    depth, width = max(a.depth for a in architectures), max(a.width for a in architectures)
    layers = _zeros(len(architectures), mask.shape[1], depth, width)
    for k, (own, seed) in enumerate(zip(architectures, seeds, strict=True)):
        first, *inner, last = _initial(own, seed)
        layers[0][0][k, mask[k, :, 0].bool(), : own.width] = first
        for (matrix, _), values in zip(layers[1:-1], inner, strict=False):
            matrix[k, : own.width, : own.width] = values
        layers[-1][0][k, : own.width] = last
    kind = DTYPES[precision]
    layers = [(matrix.to(kind), bias.to(kind)) for matrix, bias in layers]
    gain = torch.tensor(gains, dtype=kind)[:, None, None]
    sizes = [(a.depth, a.width) for a in architectures]
    return Stack(layers, sizes, mask.to(kind), lags, float(one.increment), gain)


def padded_orders(architectures: Sequence[Architecture]) -> tuple[int, ...]:
    """The largest order of each exogenous signal over the networks of a stack."""
    return tuple(max(column) for column in zip(*(a.orders.exogenous for a in architectures), strict=True))


def _mask(one: Architecture, architectures: Sequence[Architecture]) -> Tensor:
    lags = max(a.orders.error for a in architectures)
    wanted = ((one.orders.error, lags), *zip(one.orders.exogenous, padded_orders(architectures), strict=True))
    return torch.cat([(torch.arange(most) < own).float() for own, most in wanted])


def _initial(one: Architecture, seed: int) -> list[Tensor]:
    """Matrices (n_in, n_out) of one network without padding."""
    generator = torch.Generator().manual_seed(seed)
    sizes = [one.orders.regressors, *[one.width] * one.depth, 1]
    matrices = [
        torch.randn(n_in, n_out, generator=generator) * (2.0 / n_in) ** 0.5 for n_in, n_out in pairwise(sizes)
    ]
    matrices[-1] *= 0.1
    return matrices


def _zeros(networks: int, regressors: int, depth: int, width: int) -> list[tuple[Tensor, Tensor]]:
    """Layers of zeros."""
    sizes = [regressors, *[width] * depth, 1]
    return [
        (torch.zeros(networks, n_in, n_out), torch.zeros(networks, 1, n_out))
        for n_in, n_out in pairwise(sizes)
    ]
