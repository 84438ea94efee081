"""A carriage whose truth is integrated by SciPy, one held sample at a time: no code of the package's own."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import odeint
from scipy.signal import lfilter

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.model import Model, compose
from hybridid.plants.emps import EMPS
from hybridid.plants.plant import Load, Motion, Plant
from hybridid.records.record import Channel, Record

Array = NDArray[np.float64]
SYMMETRIC = ("viscous", "coulomb", "offset")
EPSILON = 3e-3
"""Smoothing velocity of the simulated truth in m/s: ten times the plant's, so that few steps do."""


@dataclass(frozen=True)
class Carriage:
    """``M q'' = force - F`` from rest at ``centre``, ``F = (f_v -+ df_v/2 + damping_slope q) q' + (f_c +
    warming (temperature - 25 °C)) tanh(q'/epsilon) + drag q' |q'| + offset
    + stiffness exp(-t / fade) (q - centre) + ripple sin(2 pi q / pitch) + hardness max(q - wall, 0)``."""

    M: float = 95.0
    f_v: float = 203.0
    f_c: float = 20.4
    offset: float = -3.2
    df_v: float = 0.0
    drag: float = 0.0  # N s²/m²: it grows with the square of the velocity
    damping_slope: float = 0.0  # N s/m^2: the viscous friction rises by it from place to place
    stiffness: float = 0.0  # N/m, of a spring
    fade: float = math.inf  # s, in which the spring's stiffness falls to 1/e
    centre: float = 0.0  # m, where it rests
    ripple: float = 0.0  # N, a force that is periodic in position
    pitch: float = 0.02  # m, its period
    wall: float = math.inf  # m, where a stop begins
    hardness: float = 0.0  # N/m, its stiffness
    epsilon: float = EPSILON
    warming: float = 0.0  # N/K: the Coulomb friction rises by it with the temperature

    @property
    def truth(self) -> dict[str, float]:
        """The parameters of the symmetric model by their names there."""
        return {
            "M": self.M,
            "carriage.viscous.f_v": self.f_v,
            "carriage.coulomb.f_c": self.f_c,
            "carriage.offset.offset": self.offset,
        }

    def force(self, time: Array) -> Array:
        """A drive in both directions with slow and fast parts, about the offset; N."""
        slow, fast = 45 * np.sin(2 * np.pi * 0.7 * time), 30 * np.sign(np.sin(2 * np.pi * 1.9 * time + 0.3))
        return self.offset + slow + fast

    def temperature(self, time: Array) -> Array:
        """A temperature that rises and falls and comes back, °C."""
        return 25 + 8 * np.sin(2 * np.pi * 0.4 * time)

    def states(self, n: int = 600, dt: float = 0.005) -> Array:
        """Position and velocity at the samples, (n, 2)."""
        return _states(self, n, dt)

    def record(
        self, n: int = 600, dt: float = 0.005, noise: Array | None = None, name: str = "carriage"
    ) -> Record:
        """The carriage as an encoder with ``noise`` (n,) m records it, the force held; where its friction
        follows the temperature, with that as an auxiliary signal."""
        time = np.arange(n) * dt
        position = self.states(n, dt)[:, 0] + (0.0 if noise is None else noise)
        aside = (Channel("temperature", "°C", assumed=True),) if self.warming else ()
        return Record(
            name=name,
            time=time,
            inputs=self.force(time)[:, None],
            outputs=position[:, None],
            input_channels=(Channel("force", "N", "zoh"),),
            output_channels=(Channel("position", "m"),),
            auxiliary=self.temperature(time)[:, None] if aside else None,
            auxiliary_channels=aside,
            simulated=True,
        )


@cache
def _states(carriage: Carriage, n: int, dt: float) -> Array:
    force, temperature = carriage.force(np.arange(n) * dt), carriage.temperature(np.arange(n) * dt)
    states = np.zeros((n, 2))
    states[0, 0] = carriage.centre

    def rate(t: float, x: Array, u: float, f_c: float, began: float) -> list[float]:
        resist = (carriage.f_v + carriage.damping_slope * x[0]) * x[1] - 0.5 * carriage.df_v * abs(x[1])
        resist += f_c * math.tanh(x[1] / carriage.epsilon) + carriage.offset
        resist += carriage.drag * x[1] * abs(x[1])
        stiffness = carriage.stiffness * math.exp(-(began + t) / carriage.fade)
        resist += stiffness * (x[0] - carriage.centre)
        resist += carriage.ripple * math.sin(2 * math.pi * x[0] / carriage.pitch)
        resist += carriage.hardness * max(x[0] - carriage.wall, 0.0) if carriage.hardness else 0.0
        return [x[1], (u - resist) / carriage.M]

    for k in range(n - 1):
        held = (force[k], carriage.f_c + carriage.warming * (temperature[k] - 25), k * dt)
        states[k + 1] = odeint(rate, states[k], (0, dt), held, tfirst=True, rtol=1e-10, atol=1e-13)[-1]
    states.flags.writeable = False
    return states


@pytest.fixture(scope="session")
def carriage() -> Carriage:
    """The symmetric carriage, simulated."""
    return Carriage()


@pytest.fixture(scope="session")
def carriage_like() -> type[Carriage]:
    """Makes carriages of other truths, simulated."""
    return Carriage


@pytest.fixture(scope="session")
def make_model() -> Callable[..., Model]:
    """``make_model(effects, **adjustments)``: the EMPS with the simulated truth's smoothing."""

    def make(
        effects: tuple[str, ...] = SYMMETRIC, adjust: Mapping[str, Mapping[str, float]] | None = None
    ) -> Model:
        smoothing = {"carriage.epsilon": {"guess": EPSILON}} if effects else {}
        return compose(EMPS(), effects, {**smoothing, **dict(adjust or {})})

    return make


@pytest.fixture(scope="session")
def noise() -> Callable[..., Array]:
    """``noise(n, std, rho, seed)``: stationary, ``e(t) = rho e(t - 1) + white``, (n,)."""

    def make(n: int, std: float, rho: float = 0.0, seed: int = 0) -> Array:
        before = 1000
        white = np.random.default_rng(seed).normal(size=n + before) * std * np.sqrt(1 - rho**2)
        return lfilter([1.0], [1.0, -rho], white)[before:]

    return make


class PressedCarriage(EMPS):
    """The EMPS whose carriage says all that an effect may need: also a load, and the level of its friction.

    They are signals for an effect to see; the equation of motion is that of the EMPS.
    """

    ports = tuple(
        replace(port, load="a spring", level="a magnet that is stronger on one side")
        if port.name == "carriage"
        else port
        for port in EMPS.ports
    )

    def loads(self, x, u, p):
        return {"carriage": Load(drive=u.force, load=-300.0 * (x.q + 0.02), level=1.0 + 10.0 * x.q)}


@pytest.fixture(scope="session")
def pressed() -> Plant:
    """A plant at whose ports every effect of the library on a machine that moves is possible."""
    return PressedCarriage()


class Tank(Plant):
    """``A h' = inflow - F``: a tank without an outlet of its own."""

    name, meaning, source = "tank", "a tank", "the tests"
    states = (State("h", "m", scale=0.3, observed_by="level", derivative=0),)
    inputs = (Signal("inflow", "m³/s"),)
    outputs = (Signal("level", "m"),)
    parameters = (Parameter("A", "m²", guess=0.02, fixed=True),)
    ports = (
        Port("tank", "flow", "m³/s", 1e-3, "m", 0.3, velocity_scale=0.05, drive="flow of the pump"),
        Port("inflow", "input", "m³/s", 1e-3),
        Port("level", "output", "m", 0.3),
    )

    def motion(self, x, u, p):
        return {"tank": Motion(position=x.h, velocity=u.inflow / p.A)}

    def loads(self, x, u, p):
        return {"tank": Load(drive=u.inflow)}

    def derivative(self, x, u, p, effort):
        return {"h": (u.inflow - effort["tank"]) / p.A}

    def output(self, x, u, p):
        return {"level": x.h}


@pytest.fixture(scope="session")
def tank() -> Plant:
    """A plant at whose port every flow of the library is possible."""
    return Tank()


@dataclass(frozen=True)
class Leaking:
    """``A h' = inflow - c sqrt(h) - weir max(h - edge, 0)^1.5 - steady``, A = 0.02 m², first h = 0.35 m."""

    c: float = 6e-4  # m^2.5/s
    weir: float = 0.0  # m^1.5/s
    edge: float = 0.4  # m
    steady: float = 0.0  # m³/s

    def record(
        self, n: int = 600, std: float = 0.0, name: str = "tank", seed: int = 0, fast: float = 1.0
    ) -> Record:
        """Its level over ``n`` seconds, with white noise; the inflow swings ``fast`` times in 150 s."""
        time = np.arange(n, dtype=float)
        inflow = 4e-4 * (1 + np.sin(2 * np.pi * fast * time / 150) * np.cos(2 * np.pi * fast * time / 1100))

        def rate(_: float, x: Array, u: float) -> list[float]:
            flows = (
                self.c * np.sqrt(max(x[0], 0.0)) + self.weir * max(x[0] - self.edge, 0.0) ** 1.5 + self.steady
            )
            return [(u - flows) / 0.02]

        level = np.full((n, 1), 0.35)
        for k, u in enumerate(inflow[:-1]):
            level[k + 1] = odeint(rate, level[k], (0, 1.0), (u,), tfirst=True, rtol=1e-9, atol=1e-11)[-1]
        return Record(
            name,
            time,
            inflow[:, None],
            level + std * np.random.default_rng(seed).normal(size=(n, 1)),
            (Channel("inflow", "m³/s", "zoh"),),
            (Channel("level", "m"),),
            simulated=True,
        )


@pytest.fixture(scope="session")
def leaking() -> type[Leaking]:
    """Makes tanks that leak, simulated by SciPy with a sharp edge."""
    return Leaking
