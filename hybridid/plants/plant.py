"""``Plant``: the equations of motion of a machine, to which effects are added at named ports."""

from __future__ import annotations

import abc
from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import SimpleNamespace

import casadi as ca

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.naming import unknown

TOGETHER = "+"
"""Between the names of ports where one effect acts with one set of parameters."""


@dataclass(frozen=True)
class Load:
    """What the contact at an effort port carries (CasADi scalars): ``M a = drive + load - F``.

    ``drive`` is the effort of the drive's side on the contact, ``load`` that of the load's side (a weight, a
    spring), both in the port's effort unit and positive in the direction of motion. A drive that holds a
    weight has ``load = -drive``. The inertia behind the contact is no part of them. ``level`` is what sets
    the level of the friction, over its typical value, without unit. At a flow port ``drive`` is the supply:
    the flow of the pump, the power of the heater.
    """

    drive: ca.SX | float = 0.0
    load: ca.SX | float = 0.0
    level: ca.SX | float = 0.0


@dataclass(frozen=True)
class Motion:
    """Position and velocity (CasADi scalars) of a port, in the port's units.

    At a flow port they are the level, and the net flow of the plant as the rate of the level, before the
    effects. ``acceleration`` is given only where a test rig prescribes the motion, so that it is an input;
    else it follows from the equations of motion.
    """

    position: ca.SX
    velocity: ca.SX
    acceleration: ca.SX | None = None


class Plant(abc.ABC):
    """The equations of motion of a machine, without friction or any other effect.

    A subclass declares its parts as class attributes and writes three methods: ``motion``,
    ``derivative`` and ``output``. Their arguments ``x``, ``u`` and ``p`` hold CasADi scalars by
    name (``x.q``, ``u.force``, ``p.M``). ``effort`` maps the name of each effort port to the sum
    of the efforts of the effects there, which *resists* the port's motion, and the name of each flow port to
    the sum of their flows, which *lowers* its level. A plant whose ports say
    what they carry (``Port.drive``, ``load`` or ``level``) writes ``loads`` too. A plant with an output that
    efforts are part of, as a load cell or an accelerometer measures it, writes ``sensed``.

    ``alike`` groups effort ports, or flow ports, that are built alike (front and rear, left and right). What
    one of them lacks, the others most likely lack too, so a search also tries an effect at all ports of a
    group, with one set of parameters.
    """

    name: str
    meaning: str
    source: str
    states: tuple[State, ...]
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    parameters: tuple[Parameter, ...]
    ports: tuple[Port, ...]
    alike: tuple[tuple[str, ...], ...] = ()

    @abc.abstractmethod
    def motion(self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Mapping[str, Motion]:
        """Position and velocity of every effort port and flow port, by its name."""

    @abc.abstractmethod
    def derivative(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace, effort: Mapping[str, ca.SX]
    ) -> Mapping[str, ca.SX]:
        """Time derivative of every state, by the state's name, in the state's unit per second."""

    def output(self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Mapping[str, ca.SX]:
        """Every output, by its name, in its declared unit; those of ``sensed`` are left out."""
        return {}

    def sensed(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace, effort: Mapping[str, ca.SX]
    ) -> Mapping[str, ca.SX]:
        """The outputs that efforts are part of, by name: the force that a load cell measures while a rig
        prescribes the motion, the acceleration of a body."""
        return {}

    def loads(self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> Mapping[str, Load]:
        """What the contact carries at every port that declares it, by the port's name.

        ``u`` holds the inputs after the effects on their paths. The efforts of the effects at this or
        another port are not in the load.
        """
        return {}

    @property
    def equation_ports(self) -> tuple[Port, ...]:
        """The ports in the plant's equations, where an effort or a flow acts."""
        return tuple(port for port in self.ports if port.in_equations)

    def port(self, name: str) -> Port:
        """The port called ``name``; of several, as ``front+rear``, the first under the name of all.

        Raises:
            ValueError: if the plant has no such port (the message gives the nearest name), or several are not
                effort ports, or flow ports, of one unit.
        """
        by_name = {port.name: port for port in self.ports}
        for one in name.split(TOGETHER):
            if one not in by_name:
                raise ValueError(unknown(f"port of {self.name}", one, by_name))
        ports = [by_name[one] for one in name.split(TOGETHER)]
        kinds = {(port.kind, port.effort_unit, port.position_unit) for port in ports}
        if len(ports) > 1 and (len(kinds) > 1 or not ports[0].in_equations):
            raise ValueError(
                f"ports {name}: one effect acts at several effort or flow ports of one unit only"
            )
        return replace(ports[0], name=name)
