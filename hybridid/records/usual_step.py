"""The usual step of uneven stamps, so exact that a grid of it meets them to the end of the recording.

``t_k = t_0 + n_k T + e_k``: stamps of a clock that were rounded, came a little late or are missing here and
there. The median step gives the numbers n_k; the slope of a least-squares line through (n_k, t_k) is T. The
median alone has the rounding of a single stamp, which adds up to many samples: stamps of a video of 30
pictures a second have steps of 33 and 34 ms. Then every sample would be interpolated.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from hybridid.records.channel import Array

ROUNDS = 5
"""Times that the numbers of the stamps are counted anew with a better step."""
MET = 0.25
"""Of a step: no stamp may be further from the line, else the stamps follow no clock, and their median is the
usual step to two digits."""
DIGITS, ROUGH = 2, 0.05
"""Digits of a step that need not be exact, and how much of it they may change."""
AWAY = 0.2
"""Of a step: so far a grid of another step may run away until the last stamp, a tenth to either side."""
FINE = 12
"""Digits of a step at most."""


@dataclass(frozen=True)
class UsualStep:
    """A step in s, and how much another may differ from it (``slack``) without leaving the stamps."""

    seconds: float
    slack: float

    def allows(self, seconds: float) -> bool:
        """Whether a grid of steps of so many ``seconds`` meets the stamps as well."""
        return abs(seconds - self.seconds) <= self.slack


def usual_step(time: Array) -> UsualStep:
    """The usual step of the stamps ``time`` (n,) in s."""
    steps, usual = np.diff(time), float(np.median(np.diff(time)))
    rough = UsualStep(usual, ROUGH * usual)
    if not (steps > 0).all():
        return rough
    fitted, off = usual, math.inf
    for _ in range(ROUNDS):
        numbers = np.append(0.0, np.cumsum(np.maximum(np.rint(steps / fitted), 1.0)))
        slope, start = np.polyfit(numbers, time - time[0], 1)
        rest = time - time[0] - start - slope * numbers
        known, fitted, off = fitted, float(slope), float(np.abs(rest).max())
        if abs(fitted - known) <= 1e-12 * known:
            break
    if off > MET * fitted:
        return rough
    return UsualStep(fitted, AWAY * fitted / float(numbers[-1]))


def in_digits(found: Sequence[UsualStep]) -> float:
    """A step in s that all of ``found`` allow, in as few digits as that takes; or one of so many a second.
    Where there is none, the shortest of them."""
    shortest = min(found, key=lambda one: one.seconds)
    for seconds in _written(shortest.seconds):
        if all(one.allows(seconds) for one in found):
            return seconds
    return next(one for one in _written(shortest.seconds) if shortest.allows(one))


def _written(seconds: float) -> Iterator[float]:
    """``seconds`` in two digits, as one over a whole rate, and in more and more digits."""
    yield float(f"{seconds:.{DIGITS}g}")
    if seconds > 0 and (rate := round(1.0 / seconds)):
        yield float(f"{1.0 / rate:.{FINE}g}")
    for digits in range(DIGITS + 1, FINE + 1):
        yield float(f"{seconds:.{digits}g}")
    yield seconds
