"""``Effect``: one physical phenomenon, written once and usable at any port of its kind."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace

import casadi as ca

from hybridid.declarations import Parameter, Port, PortKind, State


@dataclass(frozen=True)
class Dimension:
    """A unit as powers of a port's effort, position and time: N·s/m is (1, -1, 1)."""

    effort: int = 0
    position: int = 0
    time: int = 0

    def scale(self, port: Port) -> float:
        """The natural magnitude of such a quantity at ``port``, in SI units."""
        return port.effort_scale**self.effort * port.position_scale**self.position * port.time_scale**self.time

    def unit(self, port: Port) -> str:
        """The unit's name at ``port``, such as ``N·s/m``; ``"1"`` if dimensionless."""
        powers = ((port.effort_unit, self.effort), (port.position_unit, self.position), ("s", self.time))
        above = [_power(name, n) for name, n in powers if n > 0]
        below = [_power(name, -n) for name, n in powers if n < 0]
        text = "·".join(above) or "1"
        if below:
            text += "/" + (f"({'·'.join(below)})" if len(below) > 1 else below[0])
        return text


def _power(name: str, exponent: int) -> str:
    base = f"({name})" if exponent > 1 and not name.isalnum() else name
    return base + {1: "", 2: "²", 3: "³"}[exponent]


@dataclass(frozen=True)
class EffectParameter:
    """A constant of an effect. Numbers are multiples of its dimension's scale at the port.

    ``starts`` are further starting values for a shape parameter whose cost has several
    valleys (a Stribeck velocity, a pitch). ``nests`` marks a parameter whose zero gives
    the model without the effect.
    """

    name: str
    dimension: Dimension
    meaning: str
    guess: float = 0.1
    lower: float = -math.inf
    upper: float = math.inf
    starts: tuple[float, ...] = ()
    nests: bool = False

    def at(self, port: Port) -> Parameter:
        """The parameter in the units of ``port``, under its short name."""
        s = self.dimension.scale(port)
        return Parameter(
            name=self.name,
            unit=self.dimension.unit(port),
            guess=self.guess * s,
            lower=self.lower * s,
            upper=self.upper * s,
            scale=abs(self.guess) * s or s,
            meaning=self.meaning,
        )


@dataclass(frozen=True)
class EffectState:
    """An inner state of an effect (bristle deflection, load position), zero at the start."""

    name: str
    dimension: Dimension
    meaning: str

    def at(self, port: Port) -> State:
        return State(self.name, self.dimension.unit(port), scale=self.dimension.scale(port), meaning=self.meaning)


@dataclass(frozen=True)
class Local:
    """What an effect sees at its port, as CasADi scalars.

    ``position``, ``velocity``, ``acceleration`` of an effort port, or ``signal`` of an
    input or output port; ``p`` its parameters and ``z`` its states by name; ``time`` in s.
    """

    p: SimpleNamespace
    z: SimpleNamespace
    time: ca.SX
    epsilon: ca.SX | float = 1.0
    position: ca.SX | float = 0.0
    velocity: ca.SX | float = 0.0
    acceleration: ca.SX | float = 0.0
    signal: ca.SX | float = 0.0

    @property
    def sign(self) -> ca.SX:
        """``tanh(v / epsilon)``, the smoothed sign of the velocity."""
        return ca.tanh(self.velocity / self.epsilon)

    @property
    def speed(self) -> ca.SX:
        """``v tanh(v / epsilon)``, the smoothed ``|v|``."""
        return self.velocity * self.sign


Law = Callable[[Local], ca.SX]


@dataclass(frozen=True)
class Effect:
    """One phenomenon as an increment at a port.

    At an effort port ``law`` gives the effort F that resists the motion; at an input or
    output port it gives what is added to the signal. With every ``nests`` parameter at
    zero it gives nothing, so models nest. ``dynamics`` gives the time derivative of each
    state. ``pattern`` says what tells the effect from its look-alikes.
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

    def __post_init__(self) -> None:
        if bool(self.states) != (self.dynamics is not None):
            raise ValueError(f"effect {self.id}: states and dynamics go together")
        if not any(p.nests for p in self.parameters):
            raise ValueError(f"effect {self.id}: no parameter nests it (whose zero removes it)")
