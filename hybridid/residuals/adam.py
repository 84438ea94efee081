"""``torch.optim.Adam`` for a stack of networks: the step is torch's, the moments can be reduced to some rows.

The class in torch loads its compiler at the first step, which costs every worker two seconds, as long as
small networks train. The function that it calls does not. Source: Kingma, Ba (2015), ICLR, arXiv:1412.6980.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor
from torch.optim.adam import adam


class Adam:
    """Gradient descent on ``tensors`` with momentum; ``decay`` times a tensor is added to its gradient."""

    def __init__(self, tensors: Sequence[Tensor], rate: float, decay: float) -> None:
        self.tensors = list(tensors)
        self.rate, self.decay = rate, decay
        self.first = [torch.zeros_like(t, requires_grad=False) for t in self.tensors]
        self.second = [torch.zeros_like(t, requires_grad=False) for t in self.tensors]
        self.steps = [torch.tensor(0.0) for _ in self.tensors]

    def forget(self) -> None:
        """Delete the gradients."""
        for tensor in self.tensors:
            tensor.grad = None

    @torch.no_grad()
    def step(self) -> None:
        """Take one step; every tensor must have a gradient."""
        adam(
            self.tensors,
            [t.grad for t in self.tensors if t.grad is not None],
            self.first,
            self.second,
            [],
            self.steps,
            foreach=True,
            amsgrad=False,
            beta1=0.9,
            beta2=0.999,
            lr=self.rate,
            weight_decay=self.decay,
            eps=1e-8,
            maximize=False,
        )

    def part(self, rows: Sequence[int], tensors: Sequence[Tensor]) -> Adam:
        """The optimiser for ``tensors``, which are the given rows of its own; it keeps their moments."""
        smaller = Adam(tensors, self.rate, self.decay)
        smaller.first = [moment[list(rows)] for moment in self.first]
        smaller.second = [moment[list(rows)] for moment in self.second]
        smaller.steps = [count.clone() for count in self.steps]
        return smaller
