"""``Effect``: one physical phenomenon, written once and usable at any port of its kind."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from types import SimpleNamespace
from typing import Any, Literal, get_args

import casadi as ca

from hybridid.declarations import IN_EQUATIONS, Need, Parameter, Port, PortKind, State
from hybridid.effects.dimension import Dimension
from hybridid.effects.pickling import reduced
from hybridid.effects.smooth import magnitude
from hybridid.naming import unknown

LOAD_WIDTH = 0.01
"""Rounding of the load's modulus at zero, over the effort scale of the port."""


@dataclass(frozen=True)
class EffectParameter:
    """A constant of an effect. Numbers are multiples of its dimension's scale at the port.

    ``absolute`` numbers are in SI units instead: the time constant of an amplifier does not
    depend on how fast the machine moves. ``nests`` marks a parameter that removes the effect
    from the model when it is zero.

    ``starts`` are further starting values for a shape parameter whose cost has several local
    minima (a Stribeck velocity, a pitch). ``sought`` says that starting values are estimated from
    the record as well: a ``"period"`` over the positions of the port, a ``"place"`` (one of these
    positions), a ``"frequency"`` of the model's residual over time, a ``"load"``, an
    amplitude that is a part of the inertia which the model without it has found, a ``"play"`` before such
    a load, or a ``"limit"``, 1 over a magnitude that the input exceeds. A fixed parameter that is the
    ``"mean"`` takes the mean over the records of the first channel that the effect sees.

    A ``hard`` amplitude is the stiffness of a limit. As it grows, the law becomes the ideal limit (a wall, an
    edge), so records may show no more than that it is large.

    A ``minor`` parameter does not decide whether the effect is present. A fit may leave it
    undetermined or at a bound; but one that is ``lost_above`` (the damping of a mode, which then rings no
    more) not at its upper bound.

    A ``fixed`` parameter belongs to the form of the law (a smoothing width, the window of a
    delay). It is not estimated. Its ``starts`` are alternative values, each kept fixed in a fit. One that is
    best a little ``above`` another parameter is set there once that one is known. ``smooths`` is as
    ``hybridid.declarations.Parameter`` has it.

    Raises:
        ValueError: if the guess or a start lies outside the bounds.
    """

    name: str
    dimension: Dimension
    meaning: str
    guess: float = 0.1
    lower: float = -math.inf
    upper: float = math.inf
    starts: tuple[float, ...] = ()
    nests: bool = False
    hard: bool = False
    absolute: bool = False
    fixed: bool = False
    minor: bool = False
    lost_above: bool = False
    sought: Literal["", "period", "place", "frequency", "load", "play", "limit", "mean"] = ""
    above: str = ""
    smooths: int = 0

    def __post_init__(self) -> None:
        for value in (self.guess, *self.starts):
            if not self.lower <= value <= self.upper:
                raise ValueError(
                    f"parameter {self.name}: {value:g} is outside [{self.lower:g}, {self.upper:g}]"
                )

    def scale_at(self, port: Port) -> float:
        """The scale that multiplies ``guess``, the bounds and ``starts`` at ``port``, in SI units."""
        return 1.0 if self.absolute else self.dimension.scale(port)

    def starts_at(self, port: Port) -> tuple[float, ...]:
        """The further starting values in the units of ``port``."""
        return tuple(value * self.scale_at(port) for value in self.starts)

    def at(self, port: Port) -> Parameter:
        """This parameter declared in the units of ``port``, under its short name."""
        s = self.scale_at(port)
        return Parameter(
            name=self.name,
            unit=self.dimension.unit(port),
            guess=self.guess * s,
            lower=self.lower * s,
            upper=self.upper * s,
            scale=abs(self.guess) * s or s,
            fixed=self.fixed,
            smooths=self.smooths,
            meaning=self.meaning,
        )


@dataclass(frozen=True)
class EffectState:
    """An internal state of an effect (bristle deflection, load position); its initial value is zero.

    ``scale``, ``lower`` and ``upper`` are multiples of its dimension's scale at the port. A state that
    ``follows`` the signal of an input port begins with its first sample times the effect's fixed parameter of
    that name: 1 if the input was there before the record, 0 if it was switched on with it.
    """

    name: str
    dimension: Dimension
    meaning: str
    scale: float = 1.0
    lower: float = -math.inf
    upper: float = math.inf
    follows: str = ""

    def at(self, port: Port) -> State:
        """This state declared in the units of ``port``, under its short name."""
        s = self.dimension.scale(port)
        return State(
            self.name,
            self.dimension.unit(port),
            scale=self.scale * s,
            lower=self.lower * s,
            upper=self.upper * s,
            begins_as=port.name if self.follows and port.kind == "input" else None,
            begins_by=self.follows or None,
            meaning=self.meaning,
        )


@dataclass(frozen=True)
class Local:
    """The quantities at a port that an effect may use, as CasADi scalars.

    ``position``, ``velocity``, ``acceleration`` of an effort port; ``position`` (the level), its ``rate`` of
    change and ``velocity`` (that rate without what the effects take) of a flow port; or ``signal`` of an
    input or output port, and the ``rate`` of change of an output; ``p`` its parameters, ``z`` its states by
    name; ``time`` in s. At a flow port only the ``dynamics`` of an effect may use the rate.
    ``channels`` holds the inputs of the model and its auxiliary channels by name, as they were recorded: an
    effect that uses some names them in ``Effect.channels``.

    ``drive``, ``load`` and ``level`` are those of ``hybridid.plants.plant.Load``, where the port has them: an
    effect that uses them, or the ``rate``, says so in ``Effect.needs``. ``load_width`` rounds the moduli at
    zero. It is a hundredth of the port's effort scale: a contact that carries so little loses nothing that a
    record shows, since the loss is a few per cent of what it carries.
    """

    p: SimpleNamespace
    z: SimpleNamespace
    time: ca.SX
    epsilon: ca.SX | float = 1.0
    position: ca.SX | float = 0.0
    velocity: ca.SX | float = 0.0
    acceleration: ca.SX | float = 0.0
    signal: ca.SX | float = 0.0
    rate: ca.SX | float = 0.0
    drive: ca.SX | float = 0.0
    load: ca.SX | float = 0.0
    level: ca.SX | float = 0.0
    load_width: ca.SX | float = 1.0
    channels: SimpleNamespace = field(default_factory=SimpleNamespace)

    @property
    def sign(self) -> ca.SX:
        """``tanh(v / epsilon)``, the smoothed sign of the velocity."""
        return ca.tanh(self.velocity / self.epsilon)

    @property
    def speed(self) -> ca.SX:
        """``v tanh(v / epsilon)``, the smoothed ``|v|``."""
        return magnitude(self.velocity, self.epsilon)

    @property
    def carried(self) -> ca.SX:
        """``|drive - load|``, smoothed: what the two sides press against each other.

        Where one side has no effort but that of its inertia, this is the other's effort. Where the drive
        holds a weight at rest, both count, and it is twice the weight.
        """
        return magnitude(self.drive - self.load, self.load_width)

    @property
    def driven(self) -> ca.SX:
        """``|drive|``, smoothed."""
        return magnitude(self.drive, self.load_width)

    @property
    def loaded(self) -> ca.SX:
        """``|load|``, smoothed."""
        return magnitude(self.load, self.load_width)


Law = Callable[[Local], ca.SX]


@dataclass(frozen=True)
class Effect:
    """One phenomenon as an increment at a port.

    At an effort port, ``law`` gives the effort F that resists the motion, at a flow port the flow F that
    lowers the level. At an input or output port, it gives the term that is added to the signal. With every
    ``nests`` parameter at zero, the law is zero: the model without the effect is a special case of the model
    with it.
    ``dynamics`` gives the time derivative of each state, by name.

    ``look_alikes`` are ids of effects that a record may not distinguish from this one. ``pattern``
    says how they differ, ``separating_experiment`` which recording would tell them apart.

    ``position_units`` and ``ports`` (patterns of units and of port names) say where the effect makes physical
    sense; empty means anywhere. A search respects them. A user may name any port of the same kind.
    ``needs`` is what the law uses beside the motion; a port must have it (``Port.knows``). ``channels`` names
    the inputs or auxiliary channels that the law sees; the model must have them.

    A flow may lead from one level into another. Such an effect acts at two flow ports: the law is that of the
    first, and the share of it that its parameter ``into`` says enters the second.

    An effect may be the ``sum_of`` others of the library, by their ids, which are missing together as a rule.
    It is tried where the model has none of them. Each of its amplitudes must be shown to differ from nothing:
    without one of them the effect is one of these others.

    A further branch of a law is tried only ``beside`` the effect of that id, at the same port.

    An effect is sent to another process by its name: see ``hybridid.effects.pickling``.

    Raises:
        ValueError: if no port is of its kind, its law is no function, states come without dynamics or
            dynamics without states, no parameter nests the effect, two of its parameters and states
            share a name, or ``into`` is no parameter of a flow without states.
    """

    id: str
    kind: PortKind
    title: str
    equation: str
    law: Law
    source: str
    pattern: str
    parameters: tuple[EffectParameter, ...] = ()
    states: tuple[EffectState, ...] = ()
    dynamics: Callable[[Local], Mapping[str, ca.SX]] | None = None
    look_alikes: tuple[str, ...] = ()
    separating_experiment: str = ""
    position_units: tuple[str, ...] = ()
    ports: tuple[str, ...] = ()
    needs: tuple[Need, ...] = ()
    channels: tuple[str, ...] = ()
    into: str = ""
    sum_of: tuple[str, ...] = ()
    beside: str = ""

    def __post_init__(self) -> None:
        if self.kind not in get_args(PortKind):
            raise ValueError(f"effect {self.id}: {unknown('kind', self.kind, get_args(PortKind))}")
        if not callable(self.law):
            raise ValueError(f"effect {self.id}: law is {self.law!r}, expected a function")
        if bool(self.states) != (self.dynamics is not None):
            raise ValueError(f"effect {self.id}: states and dynamics go together")
        if not any(p.nests for p in self.parameters):
            raise ValueError(f"effect {self.id}: no parameter nests it (whose zero removes it)")
        names = [p.name for p in self.parameters] + [s.name for s in self.states]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"effect {self.id}: two of its parameters and states are called {name}")
        if self.into and (self.into not in names or self.states or self.kind != "flow"):
            raise ValueError(
                f"effect {self.id}: into is {self.into!r}, no parameter of a flow without states"
            )

    @property
    def in_equations(self) -> bool:
        """Whether the effect stands in the plant's equations, as an effort or a flow."""
        return self.kind in IN_EQUATIONS

    def admissible_at(self, port: Port) -> bool:
        """Whether the effect makes sense at ``port``: its kind, units and name, and what it knows."""
        return (
            self.possible_at(port) and self.suits(port.position_unit) and _fits(port.name.lower(), self.ports)
        )

    def suits(self, unit: str) -> bool:
        """Whether the effect makes sense where positions are in ``unit``."""
        return _fits(unit, self.position_units)

    def possible_at(self, port: Port) -> bool:
        """Whether ``port`` is of the effect's kind and has all that it needs."""
        return port.kind == self.kind and port.knows.issuperset(self.needs)

    def __reduce_ex__(self, protocol: Any) -> Any:
        return reduced(self) or super().__reduce_ex__(protocol)


def _fits(word: str, patterns: tuple[str, ...]) -> bool:
    return not patterns or any(fnmatchcase(word, pattern) for pattern in patterns)
