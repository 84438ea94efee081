"""Adam, ``m = b1 m + (1 - b1) g``, ``v = b2 v + (1 - b2) g²``, ``p = p - a m' / (sqrt(v') + e)``.

``m'`` and ``v'`` are ``m / (1 - b1^t)`` and ``v / (1 - b2^t)``. The same numbers as ``torch.optim.Adam``,
which loads torch's compiler at its first step: two seconds of every worker, as long as small networks train.
Source: Kingma, Ba (2015), ICLR, arXiv:1412.6980.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

B1, B2, E = 0.9, 0.999, 1e-8


class Adam:
    """Moves ``tensors`` down their gradients; ``decay`` adds so much of each to its gradient.

    ``first`` and ``second`` moments are zeros unless given, after so many ``steps``.
    """

    def __init__(self, tensors: Sequence[Tensor], rate: float, decay: float) -> None:
        self.tensors = list(tensors)
        self.rate, self.decay = rate, decay
        self.first = [torch.zeros_like(t, requires_grad=False) for t in self.tensors]
        self.second = [torch.zeros_like(t, requires_grad=False) for t in self.tensors]
        self.steps = 0

    def forget(self) -> None:
        """Let go of the gradients."""
        for tensor in self.tensors:
            tensor.grad = None

    @torch.no_grad()
    def step(self) -> None:
        """One step; every tensor has a gradient."""
        self.steps += 1
        gradients = [t.grad for t in self.tensors if t.grad is not None]
        if self.decay:
            gradients = list(torch._foreach_add(gradients, self.tensors, alpha=self.decay))
        torch._foreach_lerp_(self.first, gradients, 1 - B1)
        torch._foreach_mul_(self.second, B2)
        torch._foreach_addcmul_(self.second, gradients, gradients, 1 - B2)
        sizes = torch._foreach_sqrt(self.second)
        torch._foreach_div_(sizes, (1 - B2**self.steps) ** 0.5)
        torch._foreach_add_(sizes, E)
        torch._foreach_addcdiv_(self.tensors, self.first, sizes, -self.rate / (1 - B1**self.steps))

    def part(self, rows: Sequence[int], tensors: Sequence[Tensor]) -> Adam:
        """For ``tensors``, which are these rows of its own; their moments go on."""
        smaller = Adam(tensors, self.rate, self.decay)
        smaller.first = [moment[list(rows)] for moment in self.first]
        smaller.second = [moment[list(rows)] for moment in self.second]
        smaller.steps = self.steps
        return smaller
