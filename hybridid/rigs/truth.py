"""How a config sets a rig's truth: values by name, and laws planted at its ports."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, TypeVar

from hybridid.naming import unknown
from hybridid.plain import build
from hybridid.rigs.law_library import law_named, plant
from hybridid.rigs.laws import Planted, RigError

T = TypeVar("T")
TURNING: Mapping[str, str] = {"N": "N m", "m": "rad", "kg": "kg m^2"}
"""Units of the laws on a rotary machine; the laws declare those of a linear one."""


@dataclass(frozen=True)
class PlantedAt:
    """A law at one of a rig's ports."""

    port: str
    what: Planted

    def described(self) -> dict[str, Any]:
        """Port, name, values and fingerprint as plain data, for a digest or a file."""
        return {"port": self.port, **self.what.described()}

    def said(self, turns: bool = False) -> str:
        """``coulomb at motor (f_c 0.02 N m)``; ``turns``: the machine is rotary."""
        units = {name: _unit(unit, turns) for name, unit in self.what.law.parameters}
        inside = ", ".join(f"{name} {value:g} {units[name]}".rstrip() for name, value in self.what.values)
        return f"{self.what.law.name} at {self.port} ({inside})"


def at(port: str, law: str, **values: float) -> PlantedAt:
    """``at("motor", "viscous", f_v=0.004)``: a law of the library, with its values, at a port.

    Raises:
        RigError: for an unknown law, or a value that is missing, unknown or out of its range.
    """
    return PlantedAt(port, plant(law, **values))


def planted_laws(entries: Any, ports: Sequence[str], where: str = "rig.planted") -> tuple[PlantedAt, ...]:
    """The laws that a config plants: ``[{law: stribeck, port: motor, amplitude: 0.02, velocity: 1.0}, ...]``.

    ``port`` may be omitted if the rig has only one.

    Raises:
        RigError: in one line for an unknown law, port or parameter, or a value that is not allowed.
    """
    if not isinstance(entries, Sequence) or isinstance(entries, str):
        example = f"[{{law: viscous, port: {ports[0]}, f_v: 0.1}}]"
        raise RigError(f"{where} is {entries!r}: give a list, as in {example}")
    return tuple(_planted_at(entry, ports, f"{where}[{i}]") for i, entry in enumerate(entries))


def revised(truth: T, values: Any, where: str = "rig.truth") -> T:
    """``truth``, a frozen dataclass, with the numbers ``values`` by name in place of its own.

    Raises:
        RigError: in one line for an unknown name or a value that is not allowed.
    """
    names = [field.name for field in fields(truth) if field.name != "planted"]  # type: ignore[arg-type]
    if not isinstance(values, Mapping):
        raise RigError(f"{where} is {values!r}: give values by name, of {', '.join(names)}")
    for name in values:
        if name not in names:
            raise RigError(f"{where}: {unknown('value', name, names)}")
    return build(type(truth), {**vars(truth), **values}, where, RigError)


def _planted_at(entry: Any, ports: Sequence[str], where: str) -> PlantedAt:
    if not isinstance(entry, Mapping) or "law" not in entry:
        raise RigError(f"{where} is {entry!r}: give a law, its port and its values")
    values = {key: value for key, value in entry.items() if key not in ("law", "port")}
    port = str(entry.get("port") or (ports[0] if len(ports) == 1 else None))
    if port not in ports:
        raise RigError(f"{where}: {unknown('port', port, ports)}")
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise RigError(f"{where}: {name} is {value!r}: expected a number")
    try:
        return PlantedAt(port, law_named(str(entry["law"]))(**values))
    except RigError as wrong:
        raise RigError(f"{where}: {wrong}") from wrong


def _unit(unit: str, turns: bool) -> str:
    return re.sub(r"\b(kg|N|m)\b", lambda found: TURNING[found[0]], unit) if turns else unit
