"""Horizons of which a simulation has no derivative that means anything.

Where the integrator does not resolve a motion, or the motion is chaotic, a sensitivity grows without end: one
of 10^13 claims that a change of a parameter in its last digits moves the output through all its range. One
such horizon among many then holds every step of the descent, and makes standard errors that are rounding.
Its residual counts, its sensitivities do not.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
WILD = 1e6
"""Spreads of the output by which a change of one scale moves it: more, with more than so many times what half
of the horizons show, is no derivative."""


def wild(sizes: Array) -> NDArray[np.bool_]:
    """Which horizons have a wild sensitivity; ``sizes`` (w,) are the largest of each, of an output in its
    spread by a parameter or state in its scale. None where half of them have. One that is no number is no
    matter of size: the simulation then needs shorter steps."""
    half = float(np.median(sizes)) if len(sizes) else 0.0
    return np.asarray(np.isfinite(sizes) & (sizes > WILD * max(1.0, half)))
