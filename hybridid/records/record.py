"""``Record``: one recording of a machine, checked when it is made and never changed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hybridid.naming import unknown

Hold = Literal["zoh", "foh", "bandlimited"]
HOLDS: tuple[Hold, ...] = ("zoh", "foh", "bandlimited")
Array = NDArray[np.float64]


class RecordError(ValueError):
    """A recording that cannot be used: the message says what, where and what is allowed."""


@dataclass(frozen=True)
class Channel:
    """One recorded signal.

    ``hold`` says how the signal runs between its samples: ``zoh`` held (a digital
    controller's command), ``foh`` linear, ``bandlimited`` (itself measured through an
    anti-alias filter). Only inputs use it.
    """

    name: str
    unit: str
    hold: Hold = "zoh"
    meaning: str = ""

    def __post_init__(self) -> None:
        if self.hold not in HOLDS:
            raise RecordError(f"channel {self.name}: hold is {self.hold!r}, allowed: {', '.join(HOLDS)}")


@dataclass(frozen=True, eq=False)
class Record:
    """One evenly sampled recording.

    Shapes: ``time`` (n,) in s, ``inputs`` (n, n_u), ``outputs`` (n, n_y),
    ``auxiliary`` (n, n_a) for signals that a plot shows but no model uses.
    ``simulated`` marks whatever comes from a virtual rig; it travels with every result.
    ``digest`` is the SHA-256 of the file it came from, or of the rig's configuration.
    ``warnings`` are what was noticed on the way; those of its own check are added.

    Raises:
        RecordError: if shapes or lengths disagree, a value is not finite, the time
            stamps are not even and increasing, or the record is too short.
    """

    name: str
    time: Array
    inputs: Array
    outputs: Array
    input_channels: tuple[Channel, ...]
    output_channels: tuple[Channel, ...]
    auxiliary: Array | None = None
    auxiliary_channels: tuple[Channel, ...] = ()
    simulated: bool = False
    source: str = ""
    digest: str = ""
    warnings: tuple[str, ...] = field(default=())
    _seen_by_check: tuple[str, ...] = field(init=False, repr=False, default=())

    def __post_init__(self) -> None:
        from hybridid.records.checks import check_record

        for name in ("time", "inputs", "outputs", "auxiliary"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, self._frozen(name, value))
        object.__setattr__(self, "_seen_by_check", check_record(self))
        # a copy brings its warnings along, and its check repeats them
        found = dict.fromkeys((*self.warnings, *self._seen_by_check))
        object.__setattr__(self, "warnings", tuple(found))

    def _frozen(self, name: str, value: Array) -> Array:
        try:
            frozen = np.array(value, dtype=float, copy=True)
        except (TypeError, ValueError) as wrong:
            raise RecordError(f"record {self.name}: {name} is not an array of numbers: {wrong}") from wrong
        frozen.flags.writeable = False
        return frozen

    @property
    def n(self) -> int:
        """Number of samples."""
        return len(self.time)

    @property
    def dt(self) -> float:
        """Sampling time in s."""
        return float((self.time[-1] - self.time[0]) / (self.n - 1))

    @property
    def provenance(self) -> str:
        """``"simulated"`` or ``"measured"``: what to print beside every number."""
        return "simulated" if self.simulated else "measured"

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Every channel: inputs, outputs, auxiliary."""
        return (*self.input_channels, *self.output_channels, *self.auxiliary_channels)

    def output(self, name: str) -> Array:
        """The output channel ``name``, shape (n,).

        Raises:
            RecordError: if the record has no such output.
        """
        return self.outputs[:, self._index("output", name, self.output_channels)]

    def input(self, name: str) -> Array:
        """The input channel ``name``, shape (n,).

        Raises:
            RecordError: if the record has no such input.
        """
        return self.inputs[:, self._index("input", name, self.input_channels)]

    def signal(self, name: str) -> Array:
        """The channel ``name``, be it input, output or auxiliary; shape (n,).

        Raises:
            RecordError: if the record has no such signal.
        """
        column = self._index("signal", name, self.channels)
        parts = (self.inputs, self.outputs, self.auxiliary)
        return np.hstack([part for part in parts if part is not None])[:, column]

    def _index(self, what: str, name: str, channels: tuple[Channel, ...]) -> int:
        names = [channel.name for channel in channels]
        if name not in names:
            raise RecordError(f"record {self.name}: {unknown(what, name, names)}")
        return names.index(name)

    def part(self, start: int, stop: int, name: str | None = None) -> Record:
        """Samples ``start`` to ``stop`` (exclusive) as a record of their own.

        How the record was made is still true of a part; what the check saw in it may not be.
        """
        cut = slice(start, stop)
        return replace(
            self,
            name=name or self.name,
            time=self.time[cut],
            inputs=self.inputs[cut],
            outputs=self.outputs[cut],
            auxiliary=None if self.auxiliary is None else self.auxiliary[cut],
            warnings=tuple(w for w in self.warnings if w not in self._seen_by_check),
        )
