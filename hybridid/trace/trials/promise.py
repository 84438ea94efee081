"""Which pairs of effects promise most: the least-squares fit of the residual by the columns of both.

With the columns C of the shapes that two effects take (``hybridid.trace.trials.sensitivity``), and the
residual r,

    drop = r'C (C'C)^-1 C'r

is the decrease of the squared error that both promise together, to first order. A pair is accepted only if
each member takes its share of the error beside the other one. Its promise is the smaller of the two shares,

    min over a, b of  (drop(a, b) - drop(a)) / (r'r - drop(a)),

drop(a) being that of a alone at its best shape. So a pair whose one member takes all that both take promises
nothing. An amplitude that cannot be negative must not come out negative. The fitted horizons alone decide; no
held-out one has a part in it.

Of those whose members may both take enough, the pair that leaves the smallest squared error is the most
likely one (maximum likelihood). But the first order may mislead about either. So the pairs come in turn from
both orders: by the error that they leave, and by the smaller share.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, combinations, zip_longest

import numpy as np
from numpy.typing import NDArray

from hybridid.trace.candidates import Candidate
from hybridid.trace.trials.sensitivity import Seen

Array = NDArray[np.float64]
RIDGE = 1e-10
"""Of the squared columns: keeps those that are nearly alike from blowing up."""


@dataclass(frozen=True)
class Promise:
    """Two effects, the ``starts`` of the shapes that promise most, the ``share`` that each of the two at
    least takes from the squared residual beside the other one, and that both take ``together``."""

    first: Candidate
    second: Candidate
    starts: tuple[Mapping[str, float], Mapping[str, float]]
    share: float
    together: float = 0.0

    @property
    def free_parameters(self) -> int:
        """How many parameters of the two are estimated."""
        return self.first.free_parameters + self.second.free_parameters

    @property
    def inner_states(self) -> int:
        """States that the two add to a model."""
        return self.first.inner_states + self.second.inner_states


def promises(seen: Sequence[Seen], collinear: float) -> list[Promise]:
    """Every pair that promises something, by the smaller share.

    Two declared look-alikes whose columns correlate by more than ``collinear`` are no pair: these records
    cannot tell one from the other. Nor is one effect at a port and at ports alike that hold it.
    """
    shapes = [shape for one in seen for shape in one.shapes]
    if not shapes:
        return []
    columns = [shape.columns / _size(shape.columns) for shape in shapes]
    residual = next(one.residual for one in seen if one.shapes)
    fit = _Fit.of(columns, residual, [shape.positive for shape in shapes])
    numbers = iter(range(len(shapes)))
    places = [[next(numbers) for _ in one.shapes] for one in seen]
    alone = [max((fit.drop((k,)) for k in own), default=0.0) for own in places]
    total = float(residual @ residual)
    found = []
    for a, b in combinations(range(len(seen)), 2):
        one, other = seen[a].candidate, seen[b].candidate
        pairs = [(s, t) for s in places[a] for t in places[b]]
        if not pairs or overlap(one, other):
            continue
        if _look_alikes(one, other):
            pairs = [pair for pair in pairs if fit.correlation(*pair) <= collinear]
        drops = [fit.drop(pair) for pair in pairs]
        if not drops or total <= 0:
            continue
        best = int(np.argmax(drops))
        left = [total - alone[k] for k in (a, b)]
        share = min((1 - (total - drops[best]) / one) if one > RIDGE * total else 0.0 for one in left)
        if share > 0:
            s, t = pairs[best]
            starts = shapes[s].start, shapes[t].start
            found.append(Promise(one, other, starts, share, drops[best] / total))
    return sorted(found, key=lambda promise: -promise.share)


def most_promising(found: Sequence[Promise], least: float) -> list[Promise]:
    """``found``, which are in the order of their shares, in turn from this order and from that of what they
    take together, of those whose share is at least ``least``."""
    together = sorted((one for one in found if one.share >= least), key=lambda one: -one.together)
    in_turn = chain.from_iterable(zip_longest(together, found))
    return list({id(one): one for one in in_turn if one is not None}.values())


def promised_alone(one: Seen) -> float:
    """The share of the squared residual that an effect takes at its best shape; 0 if it shows none."""
    total = float(one.residual @ one.residual)
    drops = [
        _Fit.of([shape.columns / _size(shape.columns)], one.residual, [shape.positive]).drop((0,))
        for shape in one.shapes
    ]
    return max(drops, default=0.0) / total if total > 0 else 0.0


def overlap(one: Candidate, other: Candidate) -> bool:
    """Whether both are the same effect, and one port has it twice."""
    return one.effect.id == other.effect.id and not set(one.ports).isdisjoint(other.ports)


def _look_alikes(one: Candidate, other: Candidate) -> bool:
    return one.effect.id in other.effect.look_alikes or other.effect.id in one.effect.look_alikes


@dataclass(frozen=True, eq=False)
class _Fit:
    """The products of all columns with each other and with the residual; the places of each block."""

    gram: Array
    right: Array
    blocks: tuple[Array, ...]
    positive: Array

    @classmethod
    def of(cls, columns: Sequence[Array], residual: Array, positive: Sequence[Sequence[bool]]) -> _Fit:
        together = np.concatenate(columns, axis=1)
        ends = np.cumsum([block.shape[1] for block in columns])
        blocks = tuple(np.arange(end - block.shape[1], end) for block, end in zip(columns, ends, strict=True))
        signs = np.concatenate([np.asarray(each, dtype=bool) for each in positive])
        return cls(together.T @ together, together.T @ residual, blocks, signs)

    def drop(self, chosen: Sequence[int]) -> float:
        """By how much the blocks ``chosen`` lower the squared residual; nothing with a forbidden sign."""
        rows = np.concatenate([self.blocks[k] for k in chosen])
        gram, right = self.gram[np.ix_(rows, rows)], self.right[rows]
        amplitudes = np.linalg.solve(gram + RIDGE * np.eye(len(rows)), right)
        return 0.0 if (amplitudes[self.positive[rows]] < 0).any() else float(amplitudes @ right)

    def correlation(self, one: int, other: int) -> float:
        """The largest correlation between any sums of the columns of two blocks (Hotelling)."""
        a, b = self.blocks[one], self.blocks[other]
        roots = [np.linalg.cholesky(self.gram[np.ix_(r, r)] + RIDGE * np.eye(len(r))) for r in (a, b)]
        across = np.linalg.solve(roots[0], self.gram[np.ix_(a, b)])
        return float(np.linalg.norm(np.linalg.solve(roots[1], across.T), 2))


def _size(columns: Array) -> Array:
    return np.linalg.norm(columns, axis=0)
