"""``NARX``: a trained network on the output error of a gray box (thesis Eqs. 3-11, 4-15, 5-11)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.residuals.regressors import Scaling, exogenous, scaled_error
from hybridid.residuals.series import ErrorSeries, Surroundings
from hybridid.residuals.settings import Architecture

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Weights:
    """``matrices`` and ``biases`` of the layers in order, (n_out, n_in) and (n_out,) each.

    The first layer's inputs are the past errors, the newest first, then what ``exogenous`` gives.
    """

    matrices: tuple[Array, ...]
    biases: tuple[Array, ...]

    @property
    def count(self) -> int:
        """Number of weights and biases."""
        return sum(a.size for a in (*self.matrices, *self.biases))

    def seeing(self, regressors: NDArray[np.bool_]) -> Weights:
        """The same weights with the columns of these regressors only."""
        first = np.ascontiguousarray(self.matrices[0][:, regressors])
        return Weights((first, *self.matrices[1:]), self.biases)


def scaled_run(
    members: Sequence[Weights], rows: Array, past: Array, carry: float, limit: float
) -> tuple[Array, int]:
    """Scaled errors (m,) along exogenous regressors ``rows`` (m, d) from ``past`` ones, newest first.

    They are the mean over ``members``, each in a free run of its own; without members zero. Also gives how
    many samples all of them stayed within ``limit``: nan follows.
    """
    if not members:
        return np.zeros(len(rows)), len(rows)
    runs = [_run(weights, rows, past, carry, limit) for weights in members]
    return np.mean([error for error, _ in runs], axis=0), min(stayed for _, stayed in runs)


def _run(weights: Weights, rows: Array, past: Array, carry: float, limit: float) -> tuple[Array, int]:
    from hybridid.residuals.recursion import recur  # numba takes a quarter of a second

    first, *inner, last = weights.matrices
    lags, width = len(past), len(first)
    return recur(
        rows @ first[:, lags:].T + weights.biases[0],
        np.ascontiguousarray(first[:, :lags].T),
        np.array([matrix.T for matrix in inner]).reshape(-1, width, width),
        np.array(weights.biases[1:-1]).reshape(-1, width),
        np.ascontiguousarray(last[0]),
        float(weights.biases[-1][0]),
        past,
        carry,
        limit,
    )


@dataclass(frozen=True, eq=False)
class ErrorRun:
    """A network's free run.

    ``error`` (n,) is nan after the network diverged, ``diverged_at`` s after the start of the run (None: it
    did not diverge).
    """

    error: Array
    diverged_at: float | None
    limit: float
    unit: str

    @property
    def status(self) -> str:
        """``bounded``, or when the network diverged and beyond which error."""
        if self.diverged_at is None:
            return "bounded"
        return f"diverged at t = {self.diverged_at:.4g} s: |error| above {self.limit:.3g} {self.unit}"


@dataclass(frozen=True, eq=False)
class NARX:
    """``e(t) = F[past e, past u, past y_gray]`` for one ``output``, in its ``unit``.

    Of several ``members``, networks of one architecture from different random starts, each has its own past
    e, and e is their mean. What they learned alike remains; what each made up averages out. Without members,
    e is zero.
    Source: Hansen, Salamon (1990), IEEE Trans. Pattern Anal. Mach. Intell. 12, 993-1001.

    A network with |e| above ``limit`` has diverged. ``dt`` (s), ``input_names``, ``records`` and
    ``provenance`` are those of its training.
    """

    output: str
    unit: str
    dt: float
    input_names: tuple[str, ...]
    architecture: Architecture
    scaling: Scaling
    members: tuple[Weights, ...]
    limit: float
    seed: int
    records: tuple[str, ...]
    provenance: str

    @property
    def count(self) -> int:
        """Number of weights and biases of each member."""
        return self.members[0].count if self.members else 0

    def silent(self) -> NARX:
        """The same without members: its error is zero."""
        return replace(self, members=())

    def free_run(self, seen: Surroundings) -> ErrorRun:
        """The error (n,) along a gray box' simulation from an error of zero; it uses no measured output.

        Raises:
            ValueError: if the inputs or the sampling time are not those of its training.
        """
        self._check(seen)
        error = np.full(len(seen.gray), np.nan)
        for piece in seen.pieces:
            past = np.zeros(self.architecture.orders.error)
            found, stayed = self._recur(self._exogenous(seen, piece), past)
            error[piece] = self._between(found, piece)
            if stayed < len(found):
                at = (piece.start + stayed * self.architecture.every) * self.dt
                return ErrorRun(error, at, self.limit, self.unit)
        return ErrorRun(error, None, self.limit, self.unit)

    def one_step(self, series: ErrorSeries) -> Array:
        """Predictions from measured past errors, (n,); nan where there are too few past errors.

        For diagnosis only: in use, no error is measured.
        """
        self._check(series.seen)
        orders, every = self.architecture.orders, self.architecture.every
        found = np.full(len(series.error), np.nan)
        for piece in series.seen.pieces:
            past = scaled_error(series, piece, self.scaling, every)
            rows = self._exogenous(series.seen, piece)
            for t in range(orders.longest, len(past)):
                value, _ = self._recur(rows[t : t + 1], past[t - orders.error : t][::-1].copy())
                found[piece.start + t * every] = value[0] * self.scaling.error
        return found

    def _exogenous(self, seen: Surroundings, piece: slice) -> Array:
        return exogenous(seen, piece, self.architecture.orders, self.scaling, self.architecture.every)

    def _recur(self, rows: Array, past: Array) -> tuple[Array, int]:
        carry = float(self.architecture.increment)
        return scaled_run(self.members, rows, past, carry, self.limit / self.scaling.error)

    def _between(self, found: Array, piece: slice) -> Array:
        """The errors at every sample in the output's unit, interpolated linearly from the grid."""
        grid = np.arange(len(found)) * self.architecture.every
        return np.interp(np.arange(piece.stop - piece.start), grid, found) * self.scaling.error

    def _check(self, seen: Surroundings) -> None:
        if seen.input_names != self.input_names or seen.output != self.output:
            raise ValueError(
                f"the network predicts the error of {self.output} from {', '.join(self.input_names)}; "
                f"it was given {seen.output} and {', '.join(seen.input_names)}"
            )
        if abs(seen.dt - self.dt) > 1e-6 * self.dt:
            raise ValueError(
                f"the network for {self.output} was trained on samples every {self.dt:g} s, these come "
                f"every {seen.dt:g} s: resample in preprocess"
            )
