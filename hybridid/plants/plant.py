"""``Plant``: the equations of motion of a machine, to which effects are added at named ports."""

from __future__ import annotations

import abc
from collections.abc import Mapping
from dataclasses import dataclass
from types import SimpleNamespace

import casadi as ca

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.naming import unknown


@dataclass(frozen=True)
class Motion:
    """Position and velocity (CasADi scalars) of an effort port, in the port's units."""

    position: ca.SX
    velocity: ca.SX


class Plant(abc.ABC):
    """The equations of motion of a machine, without friction or any other effect.

    A subclass declares its parts as class attributes and writes three methods: ``motion``,
    ``derivative`` and ``output``. Their arguments ``x``, ``u`` and ``p`` hold CasADi scalars by
    name (``x.q``, ``u.force``, ``p.M``). ``effort`` maps the name of each effort port to the sum
    of the efforts of the effects there, which *resists* the port's motion.
    """

    name: str
    meaning: str
    source: str
    states: tuple[State, ...]
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    parameters: tuple[Parameter, ...]
    ports: tuple[Port, ...]

    @abc.abstractmethod
    def motion(self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Mapping[str, Motion]:
        """Position and velocity of every effort port, by its name."""

    @abc.abstractmethod
    def derivative(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace, effort: Mapping[str, ca.SX]
    ) -> Mapping[str, ca.SX]:
        """Time derivative of every state, by the state's name, in the state's unit per second."""

    @abc.abstractmethod
    def output(self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Mapping[str, ca.SX]:
        """Every output, by its name, in its declared unit."""

    @property
    def effort_ports(self) -> tuple[Port, ...]:
        """The ports where a force or torque acts."""
        return tuple(port for port in self.ports if port.kind == "effort")

    def port(self, name: str) -> Port:
        """The port called ``name``.

        Raises:
            ValueError: if the plant has no such port; the message gives the nearest name.
        """
        by_name = {port.name: port for port in self.ports}
        if name in by_name:
            return by_name[name]
        raise ValueError(unknown(f"port of {self.name}", name, by_name))
