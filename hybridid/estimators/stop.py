"""When a solver ends, and whom it tells how far it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Watch = Callable[[int, float], None]
"""``watch(iteration, cost)``, called after every iteration."""

SLOW_STEPS, SLOW_SHARE, SLOW_GAIN = 10, 1e3, 1e-3
"""Stick and slip make the cost of long horizons rough: descent then creeps from kink to kink. It
ends when ten steps gain less than a thousand times the tolerance, and less than a thousandth."""


@dataclass(frozen=True)
class Stop:
    """Most ``iterations`` at one smoothing of sign(v), and the ``tolerance`` below which a relative decrease
    of the cost counts as none."""

    iterations: int = 100
    tolerance: float = 1e-6
