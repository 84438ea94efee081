"""What a fit takes of the noise behind its residual, in horizons that are independent of each other.

With B (N, k) orthonormal over the columns of the Jacobian, noise of covariance Sigma leaves
``Q Sigma Q``, ``Q = I - B B'``, in the residual, and ``B' Sigma B`` in the fit. Both are found by fast
Fourier transforms, some horizons at a time: what is made of them stays in the processor's cache.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from hybridid.simulation.windows import in_parts, within

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Absorbed:
    """A residual and the orthonormal basis of what the fit took from it.

    Shapes: ``residual`` (w, H, n_y) and ``cells`` (w, H, n_y), zero and False where an output does not count;
    ``used`` (w, H), the samples in use; ``states`` (w, H, n_y, m), orthonormal within each horizon;
    ``parameters`` (w, H, n_y, n), orthonormal over all horizons and to ``states``.
    """

    residual: Array
    used: NDArray[np.bool_]
    cells: NDArray[np.bool_]
    states: Array
    parameters: Array

    @property
    def lengths(self) -> NDArray[np.int64]:
        """Samples of each horizon, (w,)."""
        return self.used.sum(axis=1)

    @property
    def samples(self) -> NDArray[np.int64]:
        """Samples of each output, (n_y,)."""
        return self.cells.sum(axis=(0, 1))

    def pairs(self, lags: int) -> NDArray[np.int64]:
        """Pairs of samples of each output at 0 to ``lags`` samples' distance, (n_y, lags + 1)."""
        if (self.cells == within(self.used)[..., None]).all():
            found = np.maximum(self.lengths[:, None] - np.arange(lags + 1), 0).sum(axis=0)
            return np.tile(found, (self.cells.shape[2], 1))
        length, cells = self.cells.shape[1], self.cells
        both = (cells[:, k:] & cells[:, : length - k] for k in range(min(lags + 1, length)))
        found = np.array([one.sum(axis=(0, 1)) for one in both]).T
        return np.pad(found, ((0, 0), (0, lags + 1 - found.shape[1])))


@dataclass(frozen=True)
class Basis:
    """``B`` in pieces of some horizons each, and what of it is of parameters: all but the first ``states``
    columns. Transforms have the ``size`` of a horizon's products at any distance, or at up to ``lags``."""

    pieces: tuple[_Piece, ...]
    fitted: Absorbed
    states: int
    length: int
    size: int
    lags: int

    @classmethod
    def of(cls, fitted: Absorbed, size: int, lags: int) -> Basis:
        """The basis of ``fitted``."""
        length = fitted.used.shape[1]
        near = min(fft.next_fast_len(length + lags, real=True), size)
        pieces = tuple(_Piece.of(fitted, part, size, near) for part in in_parts(*fitted.used.shape))
        return cls(pieces, fitted, fitted.states.shape[3], length, size, lags)

    def through(self, kernels: Sequence[Array]) -> list[list[Array]]:
        """``Sigma B`` (w, k, H) of each piece's outputs, for noises of autocovariance ``kernels`` (n_y of
        (H,)). Noise in different horizons counts as independent."""
        circles = [np.zeros(self.size) for _ in kernels]
        for circle, kernel in zip(circles, kernels, strict=True):
            circle[: len(kernel)] = kernel
            circle[len(circle) - len(kernel) + 1 :] = kernel[:0:-1]
        spectra = [fft.rfft(circle) for circle in circles]
        return [piece.through(spectra, self.size) for piece in self.pieces]

    def variances(self, through: Sequence[Sequence[Array]]) -> Array:
        """The parameters' variances (n,) in the coordinates of their basis, of such noises."""
        return np.diag(self._own([p.inner(z) for p, z in zip(self.pieces, through, strict=True)]))

    def _own(self, inner: Sequence[Array]) -> Array:
        own = slice(self.states, None)
        return np.asarray(sum(one[:, own, own].sum(axis=0) for one in inner))

    def expected(self, kernels: Sequence[Array], through: Sequence[Sequence[Array]]) -> Array:
        """The autocovariance (n_y, lags + 1) that such noises leave in the residual, as ``_autocovariance``
        would see it."""
        lags, counts = self.lags, self.fitted.pairs(self.lags)
        near = min(fft.next_fast_len(self.length + lags, real=True), self.size)
        inner = [piece.inner(z) for piece, z in zip(self.pieces, through, strict=True)]
        own = self._own(inner)
        for one in inner:
            one[:, self.states :, self.states :] = own
        spectra = sum(
            piece.crossed(z, one, near) for piece, z, one in zip(self.pieces, through, inner, strict=True)
        )
        crossed = fft.irfft(spectra, near)
        both = crossed[:, : lags + 1] + crossed[:, -np.arange(lags + 1)]
        each = zip(kernels, counts, both, strict=True)
        left = [count * kernel[: lags + 1] - taken for kernel, count, taken in each]
        return np.array(left) / self.fitted.samples[:, None]


@dataclass(frozen=True)
class _Piece:
    """``B`` of some horizons by output, (n_y, w, k, H), its transform, the conjugate of one that suffices for
    near products, and which ``cells`` (w, H, n_y) count."""

    value: Array
    transform: NDArray[np.complex128]
    conjugate: NDArray[np.complex128]
    cells: NDArray[np.bool_]

    @classmethod
    def of(cls, fitted: Absorbed, part: slice, size: int, near: int) -> _Piece:
        both = np.concatenate([fitted.states[part], fitted.parameters[part]], axis=3)
        value = np.ascontiguousarray(np.transpose(both, (2, 0, 3, 1)))
        transform = fft.rfft(value, size, axis=3)
        close = transform if near == size else fft.rfft(value, near, axis=3)
        return cls(value, transform, close.conj(), fitted.cells[part])

    def through(self, spectra: Sequence[NDArray[np.complex128]], size: int) -> list[Array]:
        """``Sigma B`` of each output within each horizon, (w, k, H), for the spectra of two-sided kernels."""
        found = []
        for k, (own, spectrum) in enumerate(zip(self.transform, spectra, strict=True)):
            product = fft.irfft(own * spectrum, size, axis=2)[..., : self.value.shape[3]]
            found.append(np.where(self.cells[:, None, :, k], product, 0.0))
        return found

    def inner(self, through: Sequence[Array]) -> Array:
        """``B' Sigma B`` of each horizon, (w, k, k)."""
        return np.asarray(sum(b @ z.swapaxes(1, 2) for b, z in zip(self.value, through, strict=True)))

    def crossed(self, through: Sequence[Array], inner: Array, near: int) -> NDArray[np.complex128]:
        """Cross spectra (n_y, near // 2 + 1) of B with ``Sigma B - B inner / 2``."""
        found = []
        for value, conjugate, z in zip(self.value, self.conjugate, through, strict=True):
            taken = fft.rfft(z - 0.5 * inner.swapaxes(1, 2) @ value, near, axis=2)
            found.append(np.einsum("wkf,wkf->f", conjugate, taken))
        return np.array(found)
