"""``Bench``: a machine of masses and contacts with a drive, a sensor for each output and, maybe, a loop.

    u  --(dead zone, saturation, gain, delay, lag)-->  machine  --(lag, scale, noise)-->  y

The truth between two samples is ``hybridid.rigs.machine``: Dormand-Prince with dry friction that truly
sticks, which shares nothing with the estimators. A delay splits the interval, a lag of the drive is held
over ``PIECES`` pieces of it at its exact mean, a lag of the sensor follows the straight line between them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybridid.records.record import Channel, Record
from hybridid.rigs.laws import Planted
from hybridid.rigs.loop import CascadedPD
from hybridid.rigs.machine import Machine, Motion

Array = NDArray[np.float64]
PIECES = 10


@dataclass(frozen=True)
class Drive:
    """What becomes of the recorded input on its way; ``delay`` [s] of less than one sample or of several."""

    gain: float = 1.0
    delay: float = 0.0
    lag: float = 0.0
    limit: float = math.inf
    dead_zone: float = 0.0

    def passed(self, u: float) -> float:
        alive = math.copysign(max(abs(u) - self.dead_zone, 0.0), u)
        return self.gain * min(max(alive, -self.limit), self.limit)


@dataclass(frozen=True)
class Sensor:
    """``y = scale * lagged + noise``; ``memory`` is the noise's correlation from sample to sample."""

    noise: float
    memory: float = 0.0
    scale: float = 1.0
    lag: float = 0.0

    def disturbance(self, n: int, generator: np.random.Generator) -> Array:
        """Gaussian noise (n,) of standard deviation ``noise``, an autoregression of order one."""
        white = generator.standard_normal(n)
        for k in range(1, n):
            white[k] = self.memory * white[k - 1] + math.sqrt(1 - self.memory**2) * white[k]
        return self.noise * white


@dataclass(frozen=True)
class Loop:
    """A cascaded PD on the first output; it reads its own clean encoder, or with ``recorded`` the sensor."""

    controller: CascadedPD
    gain: float
    limit: float
    recorded: bool = False


@dataclass(frozen=True)
class Bench:
    """A machine and its experiment.

    ``contacts``: port -> its direction among the coordinates; ``own`` the laws that belong to the machine;
    ``outputs``: name -> (weights of the coordinates, whether of their velocities, unit).
    ``runs``: run -> input or, with a loop, reference as a function of time (n,). ``back_emf`` [N s/m]: of the
    first coordinate's velocity the drive's effort loses so much (a DC motor); it is part of ``own``.
    """

    name: str
    mass: tuple[tuple[float, ...], ...]
    input_matrix: tuple[tuple[float, ...], ...]
    contacts: Mapping[str, tuple[float, ...]]
    own: Mapping[str, tuple[Planted, ...]]
    input: Channel
    outputs: Mapping[str, tuple[tuple[float, ...], bool, str]]
    runs: Mapping[str, Callable[[Array], Array]]
    dt: float
    duration: float
    loop: Loop | None = None
    planted: Mapping[str, tuple[Planted, ...]] = field(default_factory=dict)
    drive: Drive = Drive()
    back_emf: float = 0.0

    @property
    def machine(self) -> Machine:
        laws = tuple((*self.own.get(port, ()), *self.planted.get(port, ())) for port in self.contacts)
        return Machine(self.mass, self.input_matrix, tuple(self.contacts.values()), laws)

    def record(self, run: str, sensors: Mapping[str, Sensor], seed: int) -> Record:
        """The experiment ``run`` as ``sensors``, one an output, recorded it; marked ``simulated``."""
        n = round(self.duration / self.dt) + 1
        time = self.dt * np.arange(n)
        generator = np.random.default_rng([seed, list(self.runs).index(run)])
        noise = {name: sensor.disturbance(n, generator) for name, sensor in sensors.items()}
        asked = self.runs[run](time)
        path = _Path(self)
        u, y = np.empty(n), {name: np.empty(n) for name in self.outputs}
        measured: list[float] = []
        for k in range(n):
            for name, sensor in sensors.items():
                y[name][k] = sensor.scale * path.read(name, sensor.lag) + noise[name][k]
            measured.append(y[next(iter(y))][k] if self.loop and self.loop.recorded else path.true_position)
            u[k] = asked[k] if self.loop is None else self._command(self.loop, asked[k], measured)
            path.advance(u[k], {name: sensor.lag for name, sensor in sensors.items()})
        outputs = np.column_stack([y[name] for name in self.outputs])
        return self.recorded(run, time, u, outputs, f"league bench {self.name}, {run} run, seed {seed}")

    def recorded(self, run: str, time: Array, u: Array, y: Array, source: str) -> Record:
        """Input ``u`` (n,) and outputs ``y`` (n, n_y) as a record."""
        return Record(
            name=run,
            time=time,
            inputs=u[:, None],
            outputs=y,
            input_channels=(self.input,),
            output_channels=tuple(Channel(name, unit) for name, (_, _, unit) in self.outputs.items()),
            simulated=True,
            source=f"{source} (simulated)",
        )

    def _command(self, loop: Loop, reference: float, measured: list[float]) -> float:
        newest = [*measured[-1:], *measured[-2:-1], *measured[-3:-2]]
        newest += [newest[-1]] * (3 - len(newest))
        volts = loop.controller.command(reference, (newest[0], newest[1], newest[2]), self.dt)
        return min(max(loop.gain * volts, -loop.limit), loop.limit)


class _Path:
    """The machine on its way, with what the drive and the sensors carry from sample to sample."""

    def __init__(self, bench: Bench) -> None:
        self._bench, self._drive = bench, bench.drive
        self._motion = Motion(bench.machine, positions=np.zeros(len(bench.mass)), tolerance=1e-8)
        whole, part = divmod(bench.drive.delay, bench.dt)
        self._late = [0.0] * (int(whole) + 1)
        self._part = part
        self._lagged_input = 0.0
        self._lagged: dict[str, float] = {}

    @property
    def true_position(self) -> float:
        return float(self._motion.positions[0])

    def signal(self, name: str) -> float:
        weights, of_velocity, _ = self._bench.outputs[name]
        return float(np.dot(weights, self._motion.velocities if of_velocity else self._motion.positions))

    def read(self, name: str, lag: float) -> float:
        return self._lagged.setdefault(name, self.signal(name)) if lag else self.signal(name)

    def advance(self, u: float, lags: Mapping[str, float]) -> None:
        """One sampling time with ``u`` commanded."""
        dt, last = self._bench.dt, self._late[0]
        self._late = [*self._late[1:], self._drive.passed(u)]
        for length, force in ((self._part, last), (dt - self._part, self._late[0])):
            if length > 0:
                self._piece(length, force, lags)

    def _piece(self, length: float, force: float, lags: Mapping[str, float]) -> None:
        parts = PIECES if self._drive.lag or any(lags.values()) else 1
        h = length / parts
        for _ in range(parts):
            before = {name: self.signal(name) for name, lag in lags.items() if lag}
            self._motion.advance(h, np.array([self._through_lag(force, h)]))
            for name, start in before.items():
                self._follow(name, start, self.signal(name), h / lags[name], lags[name], h)

    def _through_lag(self, force: float, h: float) -> float:
        """Mean over ``h`` of the lagged force, which moves on to its end."""
        lag = self._drive.lag
        if not lag:
            return force
        start, kept = self._lagged_input - force, math.exp(-h / lag)
        self._lagged_input = force + start * kept
        return force + start * lag / h * (1 - kept)

    def _follow(self, name: str, start: float, end: float, ratio: float, lag: float, h: float) -> None:
        """The sensor's lag behind a straight line from ``start`` to ``end``, exactly."""
        slope = (end - start) / h
        late = self._lagged.setdefault(name, start)
        self._lagged[name] = end - slope * lag + (late - start + slope * lag) * math.exp(-ratio)
