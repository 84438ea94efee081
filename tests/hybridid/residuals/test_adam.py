"""Adam: the numbers of torch's own."""

from __future__ import annotations

import pytest
import torch

from hybridid.residuals.adam import Adam


@pytest.mark.parametrize("decay", [0.0, 0.1])
def test_its_steps_are_those_of_torch(decay):
    generator = torch.Generator().manual_seed(0)
    start = [torch.randn(3, 4, 2, generator=generator, dtype=torch.float64) for _ in range(2)]
    ours, theirs = ([t.clone().requires_grad_() for t in start] for _ in range(2))
    adam, reference = Adam(ours, 0.01, decay), torch.optim.Adam(theirs, lr=0.01, weight_decay=decay)
    for _ in range(20):
        for tensors, forget, step in (
            (ours, adam.forget, adam.step),
            (theirs, reference.zero_grad, reference.step),
        ):
            forget()
            sum((t**2 * torch.arange(1.0, 3.0)).sum() + t.sin().sum() for t in tensors).backward()
            step()
    for one, other in zip(ours, theirs, strict=True):
        torch.testing.assert_close(one, other, rtol=1e-12, atol=1e-14)
        assert (one - start[0]).abs().max() > 0.05


def test_a_part_goes_on_where_the_whole_was():
    whole = [torch.ones(3, 2, requires_grad=True)]
    adam = Adam(whole, 0.1, 0.0)
    for _ in range(3):
        adam.forget()
        (whole[0] ** 3).sum().backward()
        adam.step()
    rows = [0, 2]
    part = [whole[0].detach()[rows].clone().requires_grad_()]
    smaller = adam.part(rows, part)
    for learner, tensors in ((adam, whole), (smaller, part)):
        learner.forget()
        (tensors[0] ** 3).sum().backward()
        learner.step()
    torch.testing.assert_close(part[0], whole[0][rows], rtol=0, atol=0)
