"""The choice among trained networks: the smallest whose error on held-out blocks is nearly the lowest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from hybridid.quantities import percent

if TYPE_CHECKING:  # the choice itself need not load torch
    from hybridid.residuals.training import Trained

NEAR = 1.05
"""A held-out error up to this multiple of the lowest counts as equal. A standard error over the blocks is no
alternative: if one block holds most of the error (a bump, say), one standard error admits every network."""
RULE = (
    f"the fewest weights whose free-run RMSE on the held-out blocks is within {percent(NEAR - 1)} of the "
    "lowest; among equals the lowest"
)


def smallest_near_best(trained: Sequence[Trained]) -> Trained:
    """The network to keep of several for one output, judged on the same held-out blocks.

    Raises:
        ValueError: if every one diverged on the held-out blocks.
    """
    lowest = min(one.held_out for one in trained)
    if not np.isfinite(lowest):
        raise ValueError(f"every network for {trained[0].network.output} diverged on the held-out blocks")
    sizes = [one.network.weights.count for one in trained]
    return trained[smallest_within([one.held_out for one in trained], sizes, NEAR * lowest)]


def smallest_within(errors: Sequence[float], sizes: Sequence[int], limit: float) -> int:
    """Index of the smallest with an error of at most ``limit``; among equal sizes, of the lowest error."""
    near = [k for k, error in enumerate(errors) if error <= limit]
    return min(near, key=lambda k: (sizes[k], errors[k]))
