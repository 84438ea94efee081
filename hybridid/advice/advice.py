"""``Advice``: one line that tells what to do, beside the verdict on a fit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal[
    "bound",
    "scale",
    "decay",
    "range",
    "horizon",
    "weights",
    "stopped",
    "valley",
    "open",
    "same",
    "drift",
    "recordings",
    "smoothing",
]


@dataclass(frozen=True)
class Advice:
    """What to do about a fit, ``said`` in words. It does not change the verdict.

    ``bound``: a parameter at its bound is collinear with another. ``scale``: some parameters share one free
    scale. ``decay``: amplitude and time cannot be told apart. ``range``: a held-out record leaves what was
    fitted. ``horizon``: the horizon of the fit is too long or too short for the records. ``weights``:
    sensors of very different quality count alike. ``stopped``: a descent used all its iterations, and needs
    more, or another tolerance. ``valley``: too few starts tell whether the valley that is kept is the lowest.
    ``open``: a standard error is larger than its parameter, which is positive. ``same``: a held-out record
    holds samples that were fitted. ``drift``: a free run is bad by nature, since the model integrates or is
    unstable; horizons judge it. ``recordings``: values of its own explain each recording far better,
    or a channel of some is otherwise than in the others. ``smoothing``: the smoothing of sign(v)
    makes most of what the fit leaves.
    """

    kind: Kind
    said: str
