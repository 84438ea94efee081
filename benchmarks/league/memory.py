"""Inner states along a motion that is known: what lets a regression try effects with memory.

Given velocity v and acceleration a (n,) of a port, each function gives the states (n, n_z) that
``hybridid.effects`` names, from rest, at one value of the shape parameters. Exact from sample to sample
where the law allows it, else in small steps.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True)
def bristle(v, dt, s, r_s, v_s):
    """``s z' = v - |v| z / g(v)``, g = 1 + r_s exp(-(v/v_s)²); Dahl's for r_s = 0. Exact in the travel."""
    z = np.zeros((len(v), 1))
    for k in range(1, len(v)):
        w = 0.5 * (v[k] + v[k - 1])
        g = 1.0 + r_s * np.exp(-((w / v_s) ** 2))
        end = g * np.sign(w)
        z[k, 0] = end + (z[k - 1, 0] - end) * np.exp(-abs(w) * dt / (s * g))
    return z


@njit(cache=True)
def bouc_wen(v, dt, s, sigma):
    """``s z' = v - sigma |v| |z| z + (sigma - 1) v z²`` (n = 2), in steps of a twentieth of s."""
    z = np.zeros((len(v), 1))
    for k in range(1, len(v)):
        w = 0.5 * (v[k] + v[k - 1])
        steps = int(abs(w) * dt / (0.05 * s)) + 1
        steps = min(steps, 400)
        h, x = dt / steps, z[k - 1, 0]
        for _ in range(steps):
            x += h / s * (w - sigma * abs(w) * abs(x) * x + (sigma - 1.0) * w * x * x)
            x = min(max(x, -1.0), 1.0)
        z[k, 0] = x
    return z


@njit(cache=True)
def relaxing(v, dt, tau):
    """``x' = v - x/tau``, exactly for v constant over a sample."""
    x = np.zeros((len(v), 1))
    kept = np.exp(-dt / tau)
    for k in range(1, len(v)):
        x[k, 0] = kept * x[k - 1, 0] + tau * (1.0 - kept) * 0.5 * (v[k] + v[k - 1])
    return x


@njit(cache=True)
def load(a, dt, frequency, zeta, gap):
    """``r' = w,  w' = -a - omega² dz(r) - 2 zeta omega w [touching]``: a load behind spring and play."""
    x = np.zeros((len(a), 2))
    omega = 2.0 * np.pi * frequency
    steps = int(omega * dt / 0.02) + 1
    h = dt / steps
    r, w = 0.0, 0.0
    for k in range(1, len(a)):
        push = 0.5 * (a[k] + a[k - 1])
        for _ in range(steps):
            beyond = max(abs(r) - gap, 0.0) * np.sign(r)
            damped = 2.0 * zeta * omega if beyond != 0.0 or gap == 0.0 else 0.0
            # damping implicit, then the new velocity moves the load: stable at steps that follow the spring
            w = (w + h * (-push - omega * omega * beyond)) / (1.0 + h * damped)
            r += h * w
        x[k, 0], x[k, 1] = r, w
    return x


def _dahl(v: Array, a: Array, dt: float, p: Mapping[str, float]) -> Array:
    return bristle(v, dt, p["s"], 0.0, 1.0)


STATES: Mapping[str, Callable[[Array, Array, float, Mapping[str, float]], Array]] = {
    "dahl": _dahl,
    "lugre": lambda v, a, dt, p: bristle(v, dt, p["s"], p["r_s"], p["v_s"]),
    "bouc_wen": lambda v, a, dt, p: bouc_wen(v, dt, p["s"], p["sigma"]),
    "maxwell": lambda v, a, dt, p: relaxing(v, dt, p["tau"]),
    "flexible_mode": lambda v, a, dt, p: load(a, dt, p["frequency"], p["zeta"], 0.0),
    "backlash": lambda v, a, dt, p: load(a, dt, p["frequency"], p["zeta"], p["g"]),
}
