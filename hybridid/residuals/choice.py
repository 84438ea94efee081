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
    near = [one for one in trained if one.held_out <= NEAR * lowest]
    return min(near, key=lambda one: (one.network.weights.count, one.held_out))
