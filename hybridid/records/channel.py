"""``Channel``: one recorded signal, and ``RecordError``, raised for a recording that cannot be used."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Hold = Literal["zoh", "foh", "bandlimited"]
HOLDS: tuple[Hold, ...] = ("zoh", "foh", "bandlimited")
Array = NDArray[np.float64]


class RecordError(ValueError):
    """A recording that cannot be used: the message says what, where and what is allowed."""


@dataclass(frozen=True)
class Channel:
    """One recorded signal.

    ``hold`` is the course of the signal between its samples: ``zoh`` constant (the command of a
    digital controller), ``foh`` linear, ``bandlimited`` (measured through an anti-alias filter).
    Only inputs use it. ``assumed``: the hold is not declared, so that a trace varies it. ``constant``: it is
    a number that belongs to the record, declared with it. ``made_of``: the recorded signal that a step of
    preprocessing made it of; empty for one that was recorded. ``rounding``: the standard deviation, in its
    unit, of what the recorder rounded off, where resampling has hidden that in the samples; else 0.
    ``noise``: the standard deviation, in its unit, of the sensor's noise as the config declares it; else 0.

    Raises:
        RecordError: if ``hold`` is none of these.
    """

    name: str
    unit: str
    hold: Hold = "zoh"
    meaning: str = ""
    assumed: bool = False
    constant: bool = False
    made_of: str = ""
    rounding: float = 0.0
    noise: float = 0.0

    def __post_init__(self) -> None:
        if self.hold not in HOLDS:
            raise RecordError(f"channel {self.name}: hold is {self.hold!r}, allowed: {', '.join(HOLDS)}")


class Signals(NamedTuple):
    """All signals of one role: inputs, outputs or auxiliary signals; ``values`` is (n, n_channels)."""

    role: str
    values: Array
    channels: tuple[Channel, ...]
