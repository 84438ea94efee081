"""``Over``: the variable that a learned effort or flow depends on, and the factor it is multiplied by.

At a flow port a variable is the level, the time, or an input or channel of the model. The factor is the net
flow of the declared model (a section that changes with the level), or the drive (a supply that depends on the
level). At an effort port a variable is the velocity or position, the time, the load (drive minus load), an
input or channel, or a state with memory:

    recent speed          s' = (|v| - s) / tau     a contact that warms
    recent load           s' = (|L| - s) / tau     friction that lags its load (frictional memory)
    bristle deflection    s' = (v - |v| s) / d     over its largest: Dahl's friction and Bouc-Wen's hysteresis

The factor "drive" makes what is learned a share of the drive that is lost (a force factor, a torque ripple).
The factor "acceleration" makes it an inertia m(q). Its kinetic energy ½ m(q) v² gives by
Lagrange's equation the effort m a + ½ m' v², m' = dm/dq.

Source of the frictional memory: Armstrong-Hélouvry, Dupont, Canudas de Wit (1994), Automatica 30(7).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca

from hybridid.declarations import Need, Port, Signal
from hybridid.effects.dimension import DAMPING, EFFORT, INERTIA, ONE, POSITION, TIME, VELOCITY, Dimension
from hybridid.effects.effect import EffectParameter, EffectState, Local
from hybridid.effects.variable import Variable

Factor = Literal["", "velocity", "sign of velocity", "acceleration", "drive", "net flow"]
RECENT: Variable = "recent speed"
RECENT_LOAD: Variable = "recent load"
BRISTLE: Variable = "bristle deflection"


@dataclass(frozen=True)
class Over:
    """What a learned effort depends on: a function of ``variable``, times ``factor``.

    ``signal`` is the input or channel of the model that the variable ``input`` stands for.
    """

    variable: Variable
    factor: Factor = ""
    signal: Signal | None = None

    def __str__(self) -> str:
        return f"{self.name}, times {self.factor}" if self.factor else self.name

    @property
    def name(self) -> str:
        """Of the variable; that of an input, unless it could be taken for a variable of the port."""
        if self.signal is None:
            return self.variable
        return f"input {self.signal.name}" if self.signal.name in _DIMENSIONS else self.signal.name

    @property
    def dimension(self) -> Dimension:
        """Of the variable."""
        if self.signal is not None:
            return Dimension(channel=1, channel_unit=self.signal.unit)
        return _DIMENSIONS[self.variable]

    @property
    def amplitude(self) -> Dimension:
        """Of what the factor multiplies."""
        return FACTORS[self.factor][1]

    @property
    def channels(self) -> tuple[str, ...]:
        """The inputs and channels that it sees."""
        return () if self.signal is None else (self.signal.name,)

    @property
    def needs(self) -> tuple[Need, ...]:
        """What a port must know (``Port.knows``)."""
        of_the_load = self.variable in ("load", RECENT_LOAD)
        return (*(("load",) if of_the_load else ()), *(("drive",) if self.factor == "drive" else ()))

    @property
    def bumps(self) -> int:
        """Few over the recent speed: a held-out run may be warmer than any fitted. Few over a recent load,
        which the lag smooths, and over a deflection, which its law bounds."""
        return {RECENT: 3, RECENT_LOAD: 5, BRISTLE: 5}.get(self.variable, 12)


_DIMENSIONS: Mapping[Variable, Dimension] = {
    "velocity": VELOCITY,
    RECENT: VELOCITY,
    RECENT_LOAD: EFFORT,
    "position": POSITION,
    "time": TIME,
    "load": EFFORT,
    BRISTLE: ONE,
    "level": POSITION,
}
_SYMBOLS: Mapping[Variable, str] = {
    "velocity": "v", RECENT: "r", "position": "q", "time": "t", "load": "L", RECENT_LOAD: "r", BRISTLE: "z",
    "level": "h",
}  # fmt: skip
FACTORS: Mapping[Factor, tuple[str, Dimension]] = {
    "": ("", EFFORT),
    "velocity": ("v ", DAMPING),
    "sign of velocity": ("sign(v) ", EFFORT),
    "acceleration": ("a ", INERTIA),
    "drive": ("D ", ONE),
    "net flow": ("v ", DAMPING),
}
"""The factor in an equation, and the dimension of what is learned."""
OVERS = (
    Over("velocity"),
    Over("position"),
    Over("time"),
    Over("position", "velocity"),
    Over("time", "velocity"),
    Over("position", "sign of velocity"),
    Over("time", "sign of velocity"),
    Over(RECENT, "sign of velocity"),
    Over("load"),
    Over("load", "velocity"),
    Over("load", "sign of velocity"),
    Over(RECENT_LOAD, "sign of velocity"),
    Over("position", "acceleration"),
    Over("position", "drive"),
    Over(BRISTLE),
)
FLOW_FACTORS: tuple[Factor, ...] = ("",)
INPUT_FACTORS: tuple[Factor, ...] = ("", "sign of velocity", "velocity")
"""An input or channel, such as the current of a brake, may set a damping or a friction."""
OVERS_OF_A_FLOW = (Over("level"), Over("time"), Over("level", "net flow"), Over("level", "drive"))


def overs_for(port: Port, inputs: Sequence[Signal], channels: Sequence[Signal] = ()) -> tuple[Over, ...]:
    """All that a learned effort or flow at ``port`` may depend on in a model of these inputs and channels."""
    if port.kind == "flow":
        return (*OVERS_OF_A_FLOW, *over_inputs((*inputs, *channels), FLOW_FACTORS))
    return (*OVERS, *over_inputs((*inputs, *channels)))


def over_inputs(inputs: Sequence[Signal], factors: Sequence[Factor] = INPUT_FACTORS) -> tuple[Over, ...]:
    """Each of ``inputs`` as a variable, with each of ``factors``."""
    return tuple(Over("input", factor, signal) for signal in inputs for factor in factors)


def symbol_of(over: Over) -> str:
    """The variable in an equation; a symbol of the textbooks, or the name of an input."""
    return over.name.replace(" ", "_") if over.signal else _SYMBOLS[over.variable]


def value_of(over: Over, at: Local) -> ca.SX:
    """The variable at a port."""
    if over.signal is not None:
        return getattr(at.channels, over.signal.name)
    variable = over.variable
    if variable in MEMORIES:
        return getattr(at.z, MEMORIES[variable].state.name)
    seen = {
        "velocity": at.velocity, "position": at.position, "level": at.position, "time": at.time,
        "load": at.drive - at.load,
    }  # fmt: skip
    return seen[variable]


def effort_of(over: Over, at: Local, learned: Callable[[ca.SX], ca.SX]) -> ca.SX:
    """The effort or flow of ``learned``, a function of the variable, times the factor; of an inertia, by
    Lagrange's equation."""
    if over.factor != "acceleration":
        return learned(value_of(over, at)) * factor_of(over, at)
    place = ca.SX.sym("place")
    inertia = ca.SX(learned(place))
    both = [inertia, ca.jacobian(inertia, place)]
    inertia, slope = ca.substitute(both, [place], [ca.SX(value_of(over, at))])
    return inertia * at.acceleration + 0.5 * slope * at.velocity**2


def equation_of(over: Over, learned: str) -> str:
    """``F = k |q| sign(v)``; of an inertia ``F = m a + ½ m' v², m = k |q|``."""
    if over.factor == "acceleration":
        return f"F = m a + ½ m' v², m = {learned}"
    return f"F = {learned} {FACTORS[over.factor][0]}".rstrip()


def factor_of(over: Over, at: Local) -> ca.SX | float:
    """The factor at a port."""
    factors = {
        "": 1.0, "velocity": at.velocity, "sign of velocity": at.sign, "acceleration": at.acceleration,
        "drive": at.drive, "net flow": at.velocity,
    }  # fmt: skip
    return factors[over.factor]


def _lag_of_speed(at: Local) -> dict[str, ca.SX]:
    return {"recent_speed": (at.speed - at.z.recent_speed) / at.p.tau}


def _lag_of_load(at: Local) -> dict[str, ca.SX]:
    return {"recent_load": (at.carried - at.z.recent_load) / at.p.tau}


def _deflecting(at: Local) -> dict[str, ca.SX]:
    return {"deflection": (at.velocity - at.speed * at.z.deflection) / at.p.d}


@dataclass(frozen=True)
class Memory:
    """The state of a variable with memory, its rate, and the parameter that says how far it remembers.

    The parameter may go down to its guess over ``lowest``; a second start lies at its guess over ``nearer``.
    """

    state: EffectState
    dynamics: Callable[[Local], dict[str, ca.SX]]
    name: str
    dimension: Dimension
    meaning: str
    lowest: float
    nearer: float

    def parameter(self, guess: float) -> EffectParameter:
        """The parameter, by its guess in SI units."""
        return EffectParameter(
            self.name,
            self.dimension,
            self.meaning,
            guess=guess,
            lower=guess / self.lowest,
            upper=guess * 30,
            starts=(guess / self.nearer, guess * 5),
            absolute=True,
        )


MEMORIES: Mapping[Variable, Memory] = {
    RECENT: Memory(
        EffectState("recent_speed", VELOCITY, "recent speed, a lag of |v|"),
        _lag_of_speed,
        "tau",
        TIME,
        "time constant of the lag that gives the recent speed",
        lowest=30,
        nearer=5,
    ),
    RECENT_LOAD: Memory(
        EffectState("recent_load", EFFORT, "recent load, a lag of |drive - load|"),
        _lag_of_load,
        "tau",
        TIME,
        "time constant of the lag that gives the recent load",
        lowest=300,
        nearer=30,
    ),
    BRISTLE: Memory(
        EffectState("deflection", ONE, "deflection of a bristle, over its largest"),
        _deflecting,
        "d",
        POSITION,
        "length over which the bristle deflects",
        lowest=1000,
        nearer=30,
    ),
}
