"""``Loop``: a controller with its gains and with the signals of the record that are its references."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybridid.blame import blame
from hybridid.controllers.controller import PERIOD, Controller, Reference
from hybridid.declarations import Parameter, Signal, State
from hybridid.naming import listed, unknown
from hybridid.plants.complete import complaints
from hybridid.records.record import Record

Array = NDArray[np.float64]
_DECLARED: Mapping[str, type] = {
    "references": Reference,
    "outputs": Signal,
    "commands": Signal,
    "parameters": Parameter,
    "states": State,
}


@dataclass(frozen=True)
class Loop:
    """``controller`` with ``values`` of its parameters (by default their guesses).

    ``references`` gives the record's signal for a reference of the law, by the law's name; by default the
    signal of the same name. ``every`` and ``delay`` take the place of the controller's own. The law works at
    the samples ``phase``, ``phase + every`` and so on.

    Raises:
        OwnCodeError: if the controller declares too little.
        ValueError: if it names no parameter or reference of the law, or a number is not allowed.
    """

    controller: Controller
    values: Mapping[str, float] = field(default_factory=dict)
    references: Mapping[str, str] = field(default_factory=dict)
    every: int = 0
    delay: int = -1
    phase: int = 0

    def __post_init__(self) -> None:
        check_controller(self.controller)
        law, where = self.controller, f"controller {self.controller.name}"
        if self.every == 0:
            object.__setattr__(self, "every", law.every)
        if self.delay < 0:
            object.__setattr__(self, "delay", law.delay)
        if self.every < 1 or law.memory < 0:
            raise ValueError(f"{where}: every must be 1 or more, memory 0 or more")
        if not law.commands or not law.outputs:
            raise ValueError(f"{where}: it must declare a command and an output that it reads")
        self._check_names()

    def _check_names(self) -> None:
        law, where = self.controller, f"controller {self.controller.name}"
        own = {p.name: p for p in law.parameters}
        if PERIOD in own:
            raise ValueError(f"{where}: {PERIOD} is its sampling time, and no name of a parameter")
        for name, value in self.values.items():
            if name not in own:
                raise ValueError(unknown(f"parameter of {where}:", name, own))
            if not own[name].lower <= value <= own[name].upper:
                bounds = f"[{own[name].lower:g}, {own[name].upper:g}] {own[name].unit}"
                raise ValueError(f"{where}: {name} is {value:g}, must lie in {bounds}")
        for name in self.references:
            if name not in [one.name for one in law.references]:
                raise ValueError(unknown(f"reference of {where}:", name, [r.name for r in law.references]))

    @property
    def settled(self) -> int:
        """The first sample at which the law has seen enough for its command to act."""
        return self.phase + self.controller.memory * self.every + self.delay

    def parameters(self, dt: float) -> Array:
        """What the law sees as ``p``: its parameters and its sampling time, for records of ``dt`` s."""
        own = [self.values.get(p.name, p.guess) for p in self.controller.parameters]
        return np.array([*own, self.every * dt])

    def check(self, inputs: Sequence[Signal], outputs: Sequence[Signal]) -> None:
        """Check that a plant has what the law reads and sets, in its units.

        Raises:
            ValueError: if it has not.
        """
        law = self.controller
        for what, wanted, there in (("input", law.commands, inputs), ("output", law.outputs, outputs)):
            units = {signal.name: signal.unit for signal in there}
            for one in wanted:
                if one.name not in units:
                    raise ValueError(unknown(f"{what} of controller {law.name}:", one.name, units))
                if one.unit != units[one.name]:
                    raise ValueError(
                        f"controller {law.name}: {what} {one.name} is in {one.unit}, the plant has it in "
                        f"{units[one.name]}"
                    )

    def followed(self, record: Record) -> Array:
        """The references along a record, (n, n_r).

        Raises:
            ValueError: if the record lacks one, or has it in another unit.
        """
        columns = [self._followed(record, one) for one in self.controller.references]
        return np.column_stack(columns) if columns else np.empty((record.n, 0))

    def _followed(self, record: Record, one: Reference) -> Array:
        name = self.references.get(one.name, one.name)
        units = {channel.name: channel.unit for channel in record.channels}
        where = f"controller {self.controller.name}"
        if name not in units:
            if one.optional and one.name not in self.references:
                return np.zeros(record.n)
            raise ValueError(
                f"{where}: record {record.name} has no signal {name}, which is its {one.name}; "
                f"it has {listed(list(units))}"
            )
        if units[name] != one.unit:
            raise ValueError(
                f"{where}: {one.name} is in {one.unit}, record {record.name} has {name} in {units[name]}"
            )
        return record.signal(name)


def check_controller(law: Controller) -> None:
    """Whether every declaration of a controller is there, of its type, and its names are good.

    Raises:
        OwnCodeError: with the controller's file and line, if not.
    """
    kind = type(law)
    if not isinstance(getattr(law, "name", None), str):
        blame(kind, f"controller {kind.__name__} lacks name, a text")
    for what, wanted in _DECLARED.items():
        for complaint in complaints(law, what, wanted):
            blame(kind, f"controller {law.name}: {complaint}")
    for number in ("every", "delay", "memory"):
        if not isinstance(getattr(law, number), int):
            blame(kind, f"controller {law.name}: {number} is no whole number of samples")
