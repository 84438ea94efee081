"""Which of several trained networks is kept: the smallest of those nearly the best on held-out blocks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:  # who chooses need not load torch
    from hybridid.residuals.training import Trained

NEAR = 1.05
"""A held-out error of so many times the lowest is as good. No standard error over the blocks: of one event,
such as a bump, one block holds most of the error, and then one standard error takes in every network."""
RULE = (
    f"the fewest weights whose free-run RMSE on the held-out blocks is within {NEAR - 1:.0%} of the lowest; "
    "among equals the lowest"
)


def smallest_near_best(trained: Sequence[Trained]) -> Trained:
    """The network to keep of several for one output, judged on the same held-out blocks.

    Raises:
        ValueError: if every one ran away on the held-out blocks.
    """
    lowest = min(one.held_out for one in trained)
    if not np.isfinite(lowest):
        raise ValueError(f"every network for {trained[0].network.output} ran away on the held-out blocks")
    sizes = [one.network.weights.count for one in trained]
    return trained[smallest_within([one.held_out for one in trained], sizes, NEAR * lowest)]


def smallest_within(errors: Sequence[float], sizes: Sequence[int], limit: float) -> int:
    """Number of the smallest whose error is at most ``limit``; among equals of the lowest error."""
    near = [k for k, error in enumerate(errors) if error <= limit]
    return min(near, key=lambda k: (sizes[k], errors[k]))
