"""``Bench``: one effect at a port of the test's choice, driven by a prescribed motion or signal."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import odeint

from hybridid.declarations import Port
from hybridid.effects.effect import LOAD_WIDTH, Effect, Local
from hybridid.effects.library import EFFECTS, effect_named

SEEN = (
    *("time", "epsilon", "position", "velocity", "acceleration", "signal"),
    *("rate", "drive", "load", "level", "load_width"),
)
PORTS = {
    "effort": Port("contact", "effort", "N", 10.0, "m", 0.1, velocity_scale=0.5, epsilon=1e-3),
    "rotary": Port("hinge", "effort", "N·m", 2.0, "rad", 1.0, velocity_scale=3.0, epsilon=1e-3),
    "flow": Port("tank", "flow", "m³/s", 1e-3, "m", 0.1, velocity_scale=0.05, drive="pump"),
    "input": Port("drive", "input", "V", 10.0),
    "output": Port("gauge", "output", "V", 10.0),
}


Motion = Callable[[float], Mapping[str, float]]
"""What is seen at a time, by name."""


class Rates:
    """``(t, z) -> z'`` of an effect along a motion. Its numbers go in and out in place: that is ten times as
    fast as a call with lists. The buffer holds no reference to its arrays, so they are kept here."""

    def __init__(self, function: ca.Function, given: list[list[float]], motion: Motion) -> None:
        self._motion = motion
        self._given = [np.array(numbers, float) for numbers in given]
        self._law, self._rates = np.zeros(1), np.zeros(len(given[1]))
        self._buffer, self._evaluate = function.buffer()
        for k, array in enumerate(self._given):
            self._buffer.set_arg(k, memoryview(array))
        for k, array in enumerate((self._law, self._rates)):
            self._buffer.set_res(k, memoryview(array))

    def __call__(self, t: float, z: np.ndarray) -> np.ndarray:
        seen, states, _ = self._given
        for name, value in {"time": t, **self._motion(t)}.items():
            seen[SEEN.index(name)] = value
        states[:] = z
        self._evaluate()
        return self._rates.copy()


class Bench:
    """Compiled law and rates of an effect, with its parameters at their guesses unless said otherwise."""

    def __init__(self, effect: Effect | str, **known: float) -> None:
        self.effect = effect_named(effect) if isinstance(effect, str) else effect
        self.port = PORTS["rotary" if "rad" in self.effect.position_units else self.effect.kind]
        self.p = {p.name: p.at(self.port).guess for p in self.effect.parameters} | known
        seen = {name: ca.SX.sym(name) for name in SEEN}
        p = {name: ca.SX.sym(name) for name in self.p}
        z = {s.name: ca.SX.sym(s.name) for s in self.effect.states}
        at = Local(p=SimpleNamespace(**p), z=SimpleNamespace(**z), **seen)
        rates = self.effect.dynamics(at) if self.effect.dynamics else {}
        args = [ca.vertcat(*seen.values()), ca.vertcat(*z.values()), ca.vertcat(*p.values())]
        out = [ca.SX(self.effect.law(at)), ca.vertcat(*[rates[name] for name in z])]
        self._function = ca.Function("effect", args, out)
        moving = ca.vertcat(*args)
        self._slopes = ca.Function("slopes", args, [ca.jacobian(ca.vertcat(*out), moving)])

    @property
    def n_seen(self) -> int:
        return len(SEEN)

    @property
    def amplitudes(self) -> tuple[str, ...]:
        return tuple(p.name for p in self.effect.parameters if p.nests)

    def __call__(
        self, z: Any = (), p: Mapping[str, float] | None = None, **seen: float
    ) -> tuple[float, np.ndarray]:
        """Effort (or what is added to the signal) and the rates of the states."""
        law, rates = self._function(*self._numbers(z, p, seen))
        return float(law), np.asarray(rates).ravel()

    def law(self, z: Any = (), p: Mapping[str, float] | None = None, **seen: float) -> float:
        return self(z, p, **seen)[0]

    def slopes(self, z: Any = (), p: Mapping[str, float] | None = None, **seen: float) -> np.ndarray:
        """Derivatives of law and rates by all that they see, (1 + n_z, n_seen + n_z + n_p)."""
        return np.asarray(self._slopes(*self._numbers(z, p, seen)))

    def _numbers(self, z: Any, p: Mapping[str, float] | None, seen: Mapping[str, float]) -> list[list[float]]:
        given = {"epsilon": self.port.epsilon, "load_width": LOAD_WIDTH * self.port.effort_scale, **seen}
        values = self.p | dict(p or {})
        return [[given.get(name, 0.0) for name in SEEN], list(z), list(values.values())]

    def run(self, motion: Motion, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Law (n,) and states (n, n_z) over ``time``, from states at zero; ``motion(t)`` is what is seen."""
        z = self._states(motion, time) if self.effect.states else np.zeros((len(time), 0))
        given = [self._numbers(row, None, {"time": t, **motion(t)}) for t, row in zip(time, z, strict=True)]
        law, _ = self._function(*(np.transpose(columns) for columns in zip(*given, strict=True)))
        return np.asarray(law).ravel(), z

    def _states(self, motion: Motion, time: np.ndarray) -> np.ndarray:
        """States (n, n_z) by LSODA, in at least two steps a sample."""
        rest, step = np.zeros(len(self.effect.states)), (time[1] - time[0]) / 2
        states, report = odeint(
            self.rates(motion), rest, time, tfirst=True, rtol=1e-8, atol=1e-10, hmax=step, full_output=True
        )
        assert report["message"] == "Integration successful.", report["message"]
        return states

    def rates(self, motion: Motion) -> Rates:
        """The rates of the states along ``motion``."""
        return Rates(self._function, self._numbers([0.0] * len(self.effect.states), None, {}), motion)


@pytest.fixture(scope="session")
def bench() -> type[Bench]:
    return Bench


@pytest.fixture(params=EFFECTS, ids=lambda effect: effect.id)
def any_bench(request: pytest.FixtureRequest) -> Bench:
    """Every effect of the library in turn."""
    return Bench(request.param)


@pytest.fixture(scope="session")
def value_at() -> Callable[..., float]:
    """``value_at(law, k=2.0)``: an effort at one point: q = 0.3 m, v = 0.2 m/s, a = 0.7 m/s², t = 1.5 s,
    drive - load = 3 N, force = -4 N; parameters that are not given are one, states a quarter."""

    def value(effect: Effect, **parameters: float) -> float:
        p = {q.name: 1.0 for q in effect.parameters} | parameters
        z = {state.name: 0.25 for state in effect.states}
        at = Local(
            p=SimpleNamespace(**p), z=SimpleNamespace(**z), time=ca.SX(1.5), epsilon=1e-6,
            position=ca.SX(0.3), velocity=ca.SX(0.2), acceleration=ca.SX(0.7),
            drive=ca.SX(5.0), load=ca.SX(2.0), load_width=1e-6,
            channels=SimpleNamespace(force=ca.SX(-4.0)),
        )  # fmt: skip
        return float(effect.law(at))

    return value
