"""``torch.optim.Adam`` on part of a stack: its step is torch's, its moments can be cut by rows.

The class in torch loads its compiler at the first step: two seconds of every worker, as long as small
networks train. The function below it does not. Source: Kingma, Ba (2015), ICLR, arXiv:1412.6980.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor
from torch.optim.adam import adam


class Adam:
    """Moves ``tensors`` down their gradients; ``decay`` adds so much of each to its gradient."""

    def __init__(self, tensors: Sequence[Tensor], rate: float, decay: float) -> None:
        self.tensors = list(tensors)
        self.rate, self.decay = rate, decay
        self.first = [torch.zeros_like(t, requires_grad=False) for t in self.tensors]
        self.second = [torch.zeros_like(t, requires_grad=False) for t in self.tensors]
        self.steps = [torch.tensor(0.0) for _ in self.tensors]

    def forget(self) -> None:
        """Let go of the gradients."""
        for tensor in self.tensors:
            tensor.grad = None

    @torch.no_grad()
    def step(self) -> None:
        """One step; every tensor has a gradient."""
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
        """For ``tensors``, which are these rows of its own; their moments go on."""
        smaller = Adam(tensors, self.rate, self.decay)
        smaller.first = [moment[list(rows)] for moment in self.first]
        smaller.second = [moment[list(rows)] for moment in self.second]
        smaller.steps = [count.clone() for count in self.steps]
        return smaller
