"""What a machine is made of, declared as data: signals, states, parameters and ports.

A *port* is a place where physics can act or be missing. At an effort port an
effect resists the motion: the plant's equation of motion reads
``M a = driving effort - sum of the efforts of the effects at that port``.
At a flow port an effect lowers a level q: the plant's balance reads
``S q' = inflows - outflows - sum of the flows of the effects at that port``.
At an input or output port an effect changes the signal that passes through.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal, get_args

from hybridid.naming import unknown

PortKind = Literal["effort", "flow", "input", "output"]
IN_EQUATIONS: tuple[PortKind, ...] = ("effort", "flow")
"""Kinds of port that stand in the plant's equations; a signal passes through the others."""
Need = Literal["load", "drive", "both_sides", "level", "rate"]
"""What an effect may need to see beside the motion of its port: see ``Port.knows``."""


@dataclass(frozen=True)
class Signal:
    """One measured quantity: its name, its unit and what it is."""

    name: str
    unit: str
    meaning: str = ""


@dataclass(frozen=True)
class State:
    """One state of a plant or of an effect.

    ``scale`` is a typical magnitude; the optimiser works with ``x / scale``.
    ``observed_by`` names an output: the state is its ``derivative``-th time derivative.
    A fit takes its initial value from that output. Without it, a fit estimates that of a plant's state
    for each horizon. That of an effect's state is zero where the record begins, or the input that it
    ``begins_as``, times the parameter ``begins_by``; further horizons take it over.

    Raises:
        ValueError: if the scale is not positive and finite, the bounds are crossed, or derivative is below 0.
    """

    name: str
    unit: str
    scale: float = 1.0
    lower: float = -math.inf
    upper: float = math.inf
    observed_by: str | None = None
    derivative: int = 0
    begins_as: str | None = None
    begins_by: str | None = None
    meaning: str = ""

    def __post_init__(self) -> None:
        _check_positive(f"state {self.name}", scale=self.scale)
        if not self.lower <= self.upper:
            raise ValueError(
                f"state {self.name}: bounds [{self.lower:g}, {self.upper:g}] {self.unit} are crossed"
            )
        if self.derivative < 0:
            raise ValueError(f"state {self.name}: derivative is {self.derivative}, must be 0 or more")

    def of_term(self, name: str) -> State:
        """The same state, with its parameter, under the qualified names of the term ``name``."""
        begins_by = self.begins_by and f"{name}.{self.begins_by}"
        return replace(self, name=f"{name}.{self.name}", begins_by=begins_by)


@dataclass(frozen=True)
class Parameter:
    """One constant of a model: ``lower <= value <= upper``, in ``unit``.

    ``guess`` is where a fit starts when nothing better is known, ``scale`` a typical
    magnitude. A ``fixed`` parameter is known and not estimated. Where it is a width over which the law is
    smoothed, a descent begins with it wider, by the factors of its continuation to the power ``smooths``.

    Raises:
        ValueError: if the bounds are crossed or the guess lies outside them.
    """

    name: str
    unit: str
    guess: float
    lower: float = -math.inf
    upper: float = math.inf
    scale: float = 0.0
    fixed: bool = False
    meaning: str = ""
    smooths: int = 0

    def __post_init__(self) -> None:
        if not self.lower <= self.upper:
            raise ValueError(
                f"parameter {self.name}: bounds [{self.lower:g}, {self.upper:g}] {self.unit} are crossed"
            )
        if not self.lower <= self.guess <= self.upper:
            raise ValueError(
                f"parameter {self.name}: guess {self.guess:g} is outside "
                f"[{self.lower:g}, {self.upper:g}] {self.unit}"
            )
        if self.scale < 0 or not math.isfinite(self.scale):
            raise ValueError(f"parameter {self.name}: scale must be positive and finite")
        if self.scale == 0:
            object.__setattr__(self, "scale", abs(self.guess) or 1.0)

    def renamed(self, name: str) -> Parameter:
        """The same parameter under another name."""
        return replace(self, name=name)

    def fixed_at(self, value: float) -> Parameter:
        """The same parameter, known to be ``value``."""
        return replace(self, guess=value, lower=value, upper=value, fixed=True)


@dataclass(frozen=True)
class Port:
    """A place where physics can act.

    The scales are what the machine typically sees there: effort (say 30 N), position
    (0.2 m) and velocity (0.1 m/s). Effects take their guesses and bounds from them.
    ``epsilon`` is the smoothing velocity of sign(v) ~ tanh(v / epsilon): small against
    the slowest sliding that matters. A signal port ("input", "output") has the name of
    its input or output, and uses only ``effort_unit`` and ``effort_scale``, for the signal itself.

    A flow port belongs to a balance of first order, such as that of a tank. Its position is the level q. What
    the effects there have in place of an effort is a flow that lowers it, in ``effort_unit`` (m³/s). Its
    velocity is the net flow of the declared model, as the rate of the level (m/s), before the effects. There
    is no acceleration, no ``epsilon`` and no load; its ``drive`` is the supply, such as the flow of a pump.

    ``drive`` and ``load`` say in words which effort drives the contact, and which the load exerts on it;
    ``level`` says what sets the level of its friction (a field, a pressure). ``Plant.loads`` gives their
    numbers. ``no_load`` says why a port has neither.

    Raises:
        ValueError: if the kind is none of these, a scale or epsilon is not positive and finite, or a flow
            port declares a load or a level of friction.
    """

    name: str
    kind: PortKind
    effort_unit: str
    effort_scale: float
    position_unit: str = ""
    position_scale: float = 1.0
    velocity_scale: float = 1.0
    epsilon: float = 1e-3
    meaning: str = ""
    drive: str = ""
    load: str = ""
    level: str = ""
    no_load: str = ""

    def __post_init__(self) -> None:
        where, kinds = f"port {self.name}", get_args(PortKind)
        if self.kind not in kinds:
            raise ValueError(f"{where}: {unknown('kind', self.kind, kinds)}")
        scales = {"position_scale": self.position_scale, "velocity_scale": self.velocity_scale}
        _check_positive(where, effort_scale=self.effort_scale, epsilon=self.epsilon, **scales)
        if self.kind == "flow" and (self.load or self.level):
            raise ValueError(f"{where}: a flow port carries no load; leave out its load and level")

    @property
    def in_equations(self) -> bool:
        """Whether effects there stand in the plant's equations, as an effort or a flow."""
        return self.kind in IN_EQUATIONS

    @property
    def moved(self) -> Literal[0, 1]:
        """The column of ``Model.motions`` whose rate the effects there change: 1, the velocity of an effort
        port; 0, the level of a flow port."""
        return 0 if self.kind == "flow" else 1

    @property
    def carries(self) -> bool:
        """Whether ``Plant.loads`` gives something for it."""
        return bool(self.drive or self.load or self.level)

    @property
    def knows(self) -> frozenset[Need]:
        """What of the drive, the load and the level is declared; ``load``: one of the first two. Of an output
        and of the level at a flow port the rate of change is known."""
        known: dict[Need, bool] = {
            "load": self.kind != "flow" and bool(self.drive or self.load),
            "drive": bool(self.drive),
            "both_sides": bool(self.drive and self.load),
            "level": bool(self.level),
            "rate": self.kind in ("output", "flow"),
        }
        return frozenset(need for need, given in known.items() if given)

    @property
    def time_scale(self) -> float:
        """Seconds to cross the position scale at the velocity scale."""
        return self.position_scale / self.velocity_scale


def _check_positive(where: str, **numbers: float) -> None:
    for name, value in numbers.items():
        if not 0 < value < math.inf:
            raise ValueError(f"{where}: {name} is {value:g}, must be positive and finite")
