"""The training windows and the held-out windows of a stack, as tensors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from hybridid.residuals.blocks import Blocks, blocks
from hybridid.residuals.orders import Orders
from hybridid.residuals.regressors import Scaling, exogenous, scaled_error
from hybridid.residuals.series import ErrorSeries
from hybridid.residuals.settings import Architecture, Training
from hybridid.residuals.stack import DTYPES

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Windows:
    """Windows of ``h`` grid samples for each of ``b`` networks.

    ``past`` (b, w, lags) measured errors before each, the newest first; ``rows`` (b, w, h, d) exogenous
    regressors; ``target`` (b, w, h); ``weight`` (b, w), 0 for windows that are padding.
    """

    past: Tensor
    rows: Tensor
    target: Tensor
    weight: Tensor

    def of(self, networks: Sequence[int]) -> Windows:
        """The windows of these networks only."""
        rows = list(networks)
        return Windows(self.past[rows], self.rows[rows], self.target[rows], self.weight[rows])


@dataclass(frozen=True, eq=False)
class Samples:
    """The scaled error and regressors of one task on its grid, with all pieces of all records concatenated.

    ``error`` (m,), zero where it was not measured, ``rows`` (m, d) with the orders of the whole stack;
    ``split`` into blocks, which lack what was not measured, and ``trained_on`` samples in the training blocks
    with it; ``pieces`` are the stretches simulated in one go; ``reach`` is how far back the task's own
    network looks.
    """

    error: Tensor
    rows: Tensor
    pieces: tuple[tuple[int, int], ...]
    split: Blocks
    trained_on: int
    reach: int

    @cached_property
    def doubles(self) -> tuple[Array, Array]:
        """Error (m,) and rows (m, d) as float64, for a free run."""
        return self.error.double().numpy(), self.rows.double().numpy()

    @cached_property
    def held_out(self) -> NDArray[np.int64]:
        """Indices of the samples in the held-out blocks."""
        return np.concatenate([np.arange(first, end) for first, end in self.split.held_out])


def samples_of(
    series: Sequence[ErrorSeries], scaling: Scaling, one: Architecture, padded: Orders, settings: Training
) -> Samples:
    """The samples of the task ``one`` in a stack with the orders ``padded``."""
    errors, rows, pieces, begun = [], [], [], 0
    for record in series:
        for piece in record.seen.pieces:
            errors.append(scaled_error(record, piece, scaling, one.every))
            rows.append(exogenous(record.seen, piece, padded, scaling, one.every))
            pieces.append((begun, begun + len(errors[-1])))
            begun = pieces[-1][1]
    shortest = min(end - first for first, end in pieces)
    if settings.blocks > shortest:
        output = series[0].seen.output
        raise ValueError(
            f"residual.blocks is {settings.blocks}: {output} has {shortest} samples in a stretch"
        )
    kind, found = DTYPES[settings.precision], np.concatenate(errors)
    split, gaps = blocks(pieces, settings.blocks, settings.held_out), np.isnan(found)
    return Samples(
        error=torch.from_numpy(np.where(gaps, 0.0, found)).to(kind),
        rows=torch.from_numpy(np.concatenate(rows)).to(kind),
        pieces=tuple(pieces),
        split=split.without(gaps),
        trained_on=sum(end - first for first, end in split.train),
        reach=one.orders.longest,
    )


def check_lengths(samples: Samples, settings: Training, output: str) -> None:
    """Check that training and held-out blocks are long enough for the longest horizon and the orders.

    Raises:
        ValueError: if they are too short.
    """
    horizon, split, reach = max(settings.windows, default=1), samples.split, samples.reach
    if not split.held_out:
        raise ValueError(f"{output} was measured in none of the held-out blocks: raise residual.blocks")
    parts = [("training", split.train, len(split.starts(horizon, reach)))]
    if settings.criterion == "horizon":
        parts.append(("held-out", split.held_out, len(split.checks(horizon, reach))))
    for what, runs, windows in parts:
        if not windows:
            longest = max((end - first for first, end in runs), default=0)
            raise ValueError(
                f"residual.horizons reaches {horizon} samples and the orders {reach} back, but a {what} "
                f"block of {output} has {longest}: shorten them, or lower residual.blocks ({settings.blocks})"
            )


def gather(
    samples: Sequence[Samples], starts: Sequence[NDArray[np.int64]], horizon: int, lags: int
) -> Windows:
    """The windows that begin at ``starts``, for each network; shorter lists are padded."""
    most = max(len(s) for s in starts)
    filled = torch.from_numpy(np.stack([np.resize(s, most) for s in starts]))
    weight = torch.from_numpy(np.stack([np.arange(most) < len(s) for s in starts])).float()
    ahead, back = torch.arange(horizon), -1 - torch.arange(lags)
    errors, rows = [s.error for s in samples], [s.rows for s in samples]
    coming = filled[..., None] + ahead
    past = _taken(errors, (filled[..., None] + back).clamp(min=0))
    return Windows(past, _taken(rows, coming), _taken(errors, coming), weight)


def _taken(series: Sequence[Tensor], at: Tensor) -> Tensor:
    """``series[k][at[k]]`` for each network k, stacked; in one call if all have the same series."""
    if all(one is series[0] for one in series):
        return series[0][at]
    return torch.stack([one[where] for one, where in zip(series, at, strict=True)])
