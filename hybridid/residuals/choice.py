"""The choice among trained networks: by size first, all seeds of a size together, then by seed."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite
from statistics import fmean, stdev
from typing import TYPE_CHECKING

from hybridid.quantities import percent

if TYPE_CHECKING:  # the choice itself need not load torch
    from hybridid.residuals.training import Trained

NEAR = 1.05
"""A held-out error up to this multiple of the lowest counts as equal, however well the seeds agree: less is
not worth more weights. A standard error over the blocks is no alternative: if one block holds most of the
error (a bump, say), one standard error admits every network."""
RULE = (
    "the size with the fewest weights (no network has none) whose free-run RMSE on the held-out blocks, in "
    "the mean over its seeds, is within one standard error of the lowest, or within "
    f"{percent(NEAR - 1)} if that is more; of its seeds the lowest"
)


def chosen_network(trained: Sequence[Trained]) -> Trained | None:
    """The network to keep of several for one output, judged on the same held-out blocks; None if the rule
    prefers no network.

    Raises:
        ValueError: if every one diverged on the held-out blocks.
    """
    sizes: dict[object, list[Trained]] = {}
    for one in trained:
        sizes.setdefault(one.network.architecture, []).append(one)
    own = list(sizes.values())
    if not any(isfinite(one.held_out) for one in trained):
        raise ValueError(f"every network for {trained[0].network.output} diverged on the held-out blocks")
    errors = [[one.held_out for one in seeds] for seeds in own]
    best = chosen_by_size(errors, [seeds[0].network.count for seeds in own], trained[0].zero)
    return None if best is None else own[best[0]][best[1]]


def chosen_by_size(
    errors: Sequence[Sequence[float]], weights: Sequence[int], without: float = inf
) -> tuple[int, int] | None:
    """By ``RULE``, the index of the size and of the seed among its own; None if the rule prefers no network,
    or every one diverged.

    ``errors`` are those of each size's seeds, infinite where one diverged, ``weights`` (one for each size)
    what complexity is counted in, ``without`` is the error without a network. A size of which a seed diverged
    is only chosen if there is no other.
    """
    if not any(isfinite(one) for seeds in errors for one in seeds):
        return None
    judged = [fmean(seeds) for seeds in errors]
    if min(judged) == inf:
        judged = [fmean([one for one in seeds if isfinite(one)] or [inf]) for seeds in errors]
    best = min(range(len(judged)), key=lambda k: judged[k])
    limit = max(NEAR * judged[best], judged[best] + _standard_error(errors[best]))
    if without <= limit:
        return None
    size = smallest_within(judged, weights, limit)
    return size, min(range(len(errors[size])), key=lambda k: errors[size][k])


def smallest_within(errors: Sequence[float], sizes: Sequence[int], limit: float) -> int:
    """Index of the smallest with an error of at most ``limit``; among equal sizes, of the lowest error."""
    near = [k for k, error in enumerate(errors) if error <= limit]
    return min(near, key=lambda k: (sizes[k], errors[k]))


def _standard_error(errors: Sequence[float]) -> float:
    there = [one for one in errors if isfinite(one)]
    return stdev(there) / len(there) ** 0.5 if len(there) > 1 else 0.0
