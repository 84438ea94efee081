"""Normal equations where horizons hand inner states on: each initial state meets later horizons too.

The inner states z in which horizon k begins are those in which k - 1 ended, so its outputs depend on the
parameters and on the initial states x_j of the horizons before it:

    dy_k/dp = y_p + y_z dz_k/dp,      dz_k/dp = z_p + z_z dz_(k-1)/dp,
    dy_k/dx_j = y_z dz_k/dx_j,        dz_k/dx_j = z_z dz_(k-1)/dx_j,      dz_k/dx_(k-1) = z_x,

with the derivatives of horizon k's outputs, and of the end of k - 1, by what is its own. Left out, a fit
creeps: a load behind a spring swings on for many horizons.

Horizons that follow one another make a chain, those of one record. Chains meet in the parameters alone, so
the equations have the arrow shape of ``normal_equations``, with a chain in the place of a horizon.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from hybridid.estimators.jacobian import of_each
from hybridid.estimators.normal_equations import Normal
from hybridid.estimators.problem import Problem
from hybridid.simulation.shooter import Shot

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
FORGOTTEN = 1e-4
"""Share of the norm of a horizon's own sensitivity below which an earlier initial state no longer counts."""
RIDGE = 1e-14
"""Of the scaled matrix: what no sample shows stays where it is."""


@dataclass(frozen=True)
class Coupled:
    """Scaled Gauss-Newton normal equations of ``chains``: as ``Normal``, with c chains in the place of
    horizons, and the e estimated states of each of a chain's k horizons together, ``xx`` (c, k e, k e).

    ``members`` (c, k) are the horizons of each chain, -1 where it is shorter than the longest; ``estimated``
    (w, m) marks the initial states that are estimated.
    """

    chains: Normal
    members: NDArray[np.int64]
    estimated: Mask

    @classmethod
    def of(cls, problem: Problem, shot: Shot, p_scale: Array, x_scale: Array) -> Coupled:
        """From a shot with sensitivities; steps count in ``p_scale`` (n,) and ``x_scale`` (m,)."""
        members = _chains(problem.windows.follows)
        links = _Links.of(problem, shot, members)
        square, error = links.by_all_that_is_earlier()
        x = np.tile(x_scale[links.own], members.shape[1])
        xx, xp, gx = links.of_states(square, error)
        m = len(x_scale)
        chains = Normal(
            pp=square[..., m:, m:].sum(axis=(0, 1)) * np.outer(p_scale, p_scale),
            xx=xx * np.outer(x, x),
            xp=xp * np.outer(x, p_scale),
            gp=-error[..., m:].sum(axis=(0, 1)) * p_scale,
            gx=-gx * x,
        )
        return cls(chains, members, problem.moving)

    @property
    def finite(self) -> bool:
        """Whether every number is one, and small enough to be multiplied with another."""
        return self.chains.finite

    @property
    def gp(self) -> Array:
        """Gradient by the parameters, (n_p,)."""
        return self.chains.gp

    @property
    def gx(self) -> Array:
        """Gradient by the initial states, (w, m)."""
        return self._by_horizon(self.chains.gx)

    def holding(self, states: Mask) -> Coupled:
        """The equations with the initial states in ``states`` (w, m) held where they are."""
        held = self._by_chain(states.astype(float)) > 0
        return replace(self, chains=self.chains.holding(held))

    def step(self, damping: float, fixed: Mask) -> tuple[Array, Array]:
        """The damped step (dp, dx), with the parameters in ``fixed`` held."""
        solved = _by_cholesky(self.chains, damping, fixed)
        dp, dx = _by_least_squares(self.chains, damping, fixed) if solved is None else solved
        return dp, self._by_horizon(dx)

    def predicted(self, dp: Array, dx: Array) -> float:
        """Decrease of the cost that the linear model promises for a step."""
        return self.chains.predicted(dp, self._by_chain(dx))

    def _by_chain(self, states: Array) -> Array:
        """What belongs to initial states, (w, m), as (c, k e)."""
        found = states[:, self.estimated[0]][self.members]
        found[self.members < 0] = 0.0
        return found.reshape(len(self.members), -1)

    def _by_horizon(self, chained: Array) -> Array:
        """What belongs to estimated states, (c, k e), as (w, m)."""
        found, there = np.zeros(self.estimated.shape), self.members >= 0
        found[np.ix_(self.members[there], np.flatnonzero(self.estimated[0]))] = chained.reshape(
            *self.members.shape, -1
        )[there]
        return found


def _chains(follows: Sequence[int]) -> NDArray[np.int64]:
    """The horizons (c, k) that follow one another, -1 where a chain is shorter than the longest."""
    chains: list[list[int]] = []
    of: dict[int, list[int]] = {}
    for horizon, before in enumerate(follows):
        chain = of.get(before, [])
        if not chain:
            chains.append(chain)
        chain.append(horizon)
        of[horizon] = chain
    longest = max(map(len, chains), default=0)
    return np.array([chain + [-1] * (longest - len(chain)) for chain in chains], dtype=np.int64)


@dataclass(frozen=True)
class _Links:
    """What each horizon of a chain knows of itself, and how it begins.

    The products J'J ``square`` (c, k, m + n, m + n) and J'r ``error`` (c, k, m + n) by its own initial state
    and the n parameters, and dz/dp and dz/dx_j ``begins`` (c, k, i, n + k e) of the i ``inner`` states in
    which it begins, by the parameters and by the e states ``own`` of each earlier horizon that it feels.
    """

    square: Array
    error: Array
    begins: Array
    own: Mask
    inner: Mask

    @classmethod
    def of(cls, problem: Problem, shot: Shot, members: NDArray[np.int64]) -> _Links:
        square, error = of_each(problem, shot)
        there = members >= 0
        square, error = square[members], error[members]
        square[~there], error[~there] = 0.0, 0.0
        own, inner = problem.moving[0], problem.carried
        whole = np.all(np.isfinite(shot.ends_by), axis=(1, 2))
        goes_on = whole[members][:, :-1] & there[:, 1:]
        ends = shot.ends_by[..., inner].swapaxes(1, 2)[members]
        return cls(square, error, _handed_on(square, ends, goes_on, own, inner), own, inner)

    def by_all_that_is_earlier(self) -> tuple[Array, Array]:
        """``square`` and ``error`` with what the parameters do to the states in which a horizon begins."""
        m, q = len(self.own), self.square.shape[-1]
        along = np.tile(np.eye(q), (*self.square.shape[:2], 1, 1))
        along[:, :, np.flatnonzero(self.inner), m:] += self.begins[..., : q - m]
        square = along.swapaxes(-1, -2) @ self.square @ along
        return square, (self.error[..., None, :] @ along)[..., 0, :]

    def of_states(self, square: Array, error: Array) -> tuple[Array, Array, Array]:
        """J'J (c, k e, k e) by the estimated states of each chain, (c, k e, n) by these and the parameters,
        and J'r (c, k e)."""
        c, k, m = *square.shape[:2], len(self.own)
        e, i, n = int(self.own.sum()), int(self.inner.sum()), square.shape[-1] - m
        own, inner = (np.append(mask, np.zeros(n, dtype=bool)) for mask in (self.own, self.inner))
        earlier = self.begins[..., n:]
        through, to_own = square[:, :, inner], square[:, :, own]
        back = earlier.reshape(c, k * i, k * e).swapaxes(-1, -2)
        later = (to_own[..., inner] @ earlier).reshape(c, k * e, k * e)
        xx = back @ (through[..., inner] @ earlier).reshape(c, k * i, k * e) + later + later.swapaxes(-1, -2)
        np.einsum("ckakb->ckab", xx.reshape(c, k, e, k, e))[...] += to_own[..., own]
        xp = back @ through[..., m:].reshape(c, k * i, n) + to_own[..., m:].reshape(c, k * e, n)
        gx = back @ error[..., inner].reshape(c, k * i, 1) + error[..., own].reshape(c, k * e, 1)
        return xx, xp, gx[..., 0]


def _handed_on(square: Array, ends: Array, goes_on: Mask, own: Mask, inner: Mask) -> Array:
    """``begins`` of ``_Links``. ``ends`` (c, k, i, m + n) are the derivatives of the inner states in which
    each horizon ends; the next one ``goes_on`` (c, k - 1) from there, or not."""
    c, k, i, _ = ends.shape
    m, e = len(own), int(own.sum())
    n = square.shape[-1] - m
    found = np.zeros((c, k, i, n + k * e))
    places = np.flatnonzero(inner)
    through = square[:, :, places[:, None], places]
    faint = FORGOTTEN**2 * np.diagonal(square, axis1=2, axis2=3)[..., :m][..., own]
    by_z, by_x, by_p = ends[..., :m][..., inner], ends[..., :m][..., own], ends[..., m:]
    first, now_p, now_x = 0, found[:, 0, :, :n], found[:, 0, :, n:n]
    for at in range(1, k):
        now_p = by_z[:, at - 1] @ now_p + by_p[:, at - 1]
        now_x = np.concatenate([by_z[:, at - 1] @ now_x, by_x[:, at - 1]], axis=2)
        now_p[~goes_on[:, at - 1]], now_x[~goes_on[:, at - 1]] = 0.0, 0.0
        shown = ((through[:, at] @ now_x) * now_x).sum(axis=1).reshape(c, at - first, e)
        felt = (shown > faint[:, at, None]).any(axis=2)
        if not felt.all():
            gone = int(felt.any(axis=0).argmax()) if felt.any() else at - first
            still = np.repeat(felt[:, None, gone:], e, axis=2)
            first, now_x = first + gone, np.where(still, now_x[..., gone * e :], 0.0)
        found[:, at, :, :n], found[:, at, :, n + first * e : n + at * e] = now_p, now_x
    return found


def _by_cholesky(normal: Normal, damping: float, fixed: Mask) -> tuple[Array, Array] | None:
    """The step (dp, dx) of scaled equations by eliminating chain after chain; None where rounding leaves a
    matrix that is not positive definite."""
    size, own = np.sqrt(np.diag(normal.pp)), np.sqrt(np.einsum("cii->ci", normal.xx))
    moving = (size > 0) & ~fixed
    size, own = size[moving], np.where(own > 0, own, 1.0)  # a row without a diagonal is zero
    across = normal.xp[..., moving] / (own[..., None] * size)
    found = np.concatenate([across, (normal.gx / own)[..., None]], axis=2)
    for k, matrix in enumerate(_scaled(normal.xx, own, damping) if found.size else ()):
        _, found[k], indefinite = lapack.dposv(matrix, found[k])
        if indefinite:
            return None
    taken = (across.swapaxes(1, 2) @ found).sum(axis=0)
    dp, scaled = np.zeros(len(normal.gp)), np.zeros(len(size))
    if moving.any():
        reduced = _scaled(normal.pp[np.ix_(moving, moving)], size, damping) - taken[:, :-1]
        _, solved, indefinite = lapack.dposv(reduced, normal.gp[moving] / size - taken[:, -1])
        if indefinite:
            return None
        scaled = -solved
    dp[moving] = scaled / size
    return dp, -(found[..., -1] + found[..., :-1] @ scaled) / own


def _scaled(matrix: Array, size: Array, damping: float) -> Array:
    """``matrix`` (..., n, n) over ``size`` (..., n) of its rows and columns, damped."""
    scaled: Array = matrix / (size[..., None] * size[..., None, :])
    np.einsum("...ii->...i", scaled)[...] = 1.0 + damping + RIDGE
    return scaled


def _by_least_squares(normal: Normal, damping: float, fixed: Mask) -> tuple[Array, Array]:
    """The shortest step (dp, dx) of the scaled equations, all at once."""
    n, (c, k) = len(normal.gp), normal.gx.shape
    gram = np.zeros((n + c * k, n + c * k))
    gram[:n, :n] = normal.pp
    gram[n:, :n] = normal.xp.reshape(c * k, n)
    gram[:n, n:] = gram[n:, :n].T
    np.einsum("iaib->iab", gram[n:, n:].reshape(c, k, c, k))[...] = normal.xx
    gradient, size = np.concatenate([normal.gp, normal.gx.ravel()]), np.sqrt(np.diag(gram))
    moving = size > 0
    moving[:n] &= ~fixed
    step, size = np.zeros(len(size)), size[moving]
    if moving.any():
        scaled = _scaled(gram[np.ix_(moving, moving)], size, damping)
        step[moving] = -np.linalg.lstsq(scaled, gradient[moving] / size, rcond=RIDGE)[0] / size
    return step[:n], step[n:].reshape(c, k)
