"""A simulated recording as a logger writes it, and what its simulations share. By numpy and scipy alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

STICK = 2e-3  # of the usual speed: smooths sign(v)


@dataclass(frozen=True)
class Simulated:
    """A recording's text, what ``new`` needs to be told beside it, and the truth by parameter. ``more`` are
    the texts of further recordings."""

    text: str
    truth: Mapping[str, float]
    words: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    more: tuple[str, ...] = ()


def clock(duration: float, rate: float = 500.0) -> np.ndarray:
    """Times of the samples in s, (n,)."""
    return np.arange(0, duration, 1 / rate)


def run(rates: Callable, start: list[float], t: np.ndarray) -> np.ndarray:
    """The states at the times ``t`` (n,), (n_x, n)."""
    done = solve_ivp(rates, (t[0], t[-1]), start, t_eval=t, max_step=2 * (t[1] - t[0]), rtol=1e-7, atol=1e-9)
    assert done.success
    return done.y


def noisy(signal: np.ndarray, share: float = 2e-4) -> np.ndarray:
    """``signal`` with white noise of a ``share`` of its own standard deviation."""
    return signal + np.random.default_rng(7).normal(0, share * np.std(signal), signal.shape)


def push(t: np.ndarray | float, size: float) -> np.ndarray | float:
    """A drive that swings at two frequencies, of about ``size``."""
    return size * (0.6 * np.sin(2 * np.pi * 0.5 * t) + 0.4 * np.sin(2 * np.pi * 1.3 * t + 1.0))


def sign(v: np.ndarray, usual: float) -> np.ndarray:
    """sign(v), smooth over a small part of the ``usual`` speed."""
    return np.tanh(v / (STICK * usual))


def table(
    header: str, *columns: np.ndarray, separator: str = ",", decimal: str = ".", digits: int = 9
) -> str:
    """The text of a file: the header, and a line for each sample."""
    rows = [
        separator.join(f"{value:.{digits}g}".replace(".", decimal) for value in row)
        for row in zip(*columns, strict=True)
    ]
    return "\n".join([header, *rows]) + "\n"
