"""A bench whose laws are told the drive's effort, and which says what each hidden law did.

A law with a parameter ``load`` gets the drive's effort anew for every piece of a sample over which the drive
holds it: the truth stays exact. A motor's torque changes with its back-EMF, so it is told ``PARTS`` times a
piece, each time as it is half a part later. ``Seen.efforts`` are the hidden laws' own efforts at the end of
each sample.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.league.bench import Bench, Sensor, _Path
from hybridid.records.record import Record
from hybridid.rigs.laws import Planted
from hybridid.rigs.machine import Machine, Motion

Array = NDArray[np.float64]
TOLERANCE = 1e-8
LOAD = "load"
PARTS = 10


@dataclass(frozen=True)
class Seen:
    """What happened: ``drive`` (n,) the effort as commanded, ``motion`` by port its position and velocity
    (n,), ``efforts`` (n,) of each law that was watched."""

    record: Record
    drive: Array
    motion: Mapping[str, tuple[Array, Array]]
    efforts: tuple[Array, ...]


class ToldMotion(Motion):
    """A motion that tells its laws the first input's effort at the first coordinate, less ``back_emf`` times
    the velocity there."""

    def __init__(self, machine: Machine, tolerance: float = TOLERANCE, back_emf: float = 0.0) -> None:
        super().__init__(machine, positions=np.zeros(machine.coordinates), tolerance=tolerance)
        self._machine, self._back_emf, self._gained = machine, back_emf, 0.0
        self._gain = machine.input_matrix[0][0]
        names = [[name for name, _ in planted.values] for _, planted in machine.planted]
        starts = self._tables.parameter_start
        self._told = [starts[k] + row.index(LOAD) for k, row in enumerate(names) if LOAD in row]

    def advance(self, duration: float, inputs: Array) -> None:
        """As ``Motion`` has it, with the laws told ``inputs`` (1,) first."""
        pieces = PARTS if self._back_emf and self._told else 1
        for _ in range(pieces):
            begun = self.velocities[0]
            lost = self._back_emf * (begun + self._gained / 2)
            self._tables.parameters[self._told] = self._gain * inputs[0] - lost
            super().advance(duration / pieces, inputs)
            self._gained = self.velocities[0] - begun  # as much again within the next piece

    def contact(self, c: int) -> tuple[float, float]:
        """Position and velocity of contact ``c``."""
        along = self._directions[c]
        return float(along @ self.positions), float(along @ self.velocities)

    def effort(self, k: int) -> float:
        """The effort of law ``k`` of ``Machine.planted`` now; a dry one that sticks gives none."""
        contact, planted = self._machine.planted[k]
        tables = self._tables
        z = self.law_states[tables.state_start[k] : tables.state_start[k + 1]]
        p = tables.parameters[tables.parameter_start[k] : tables.parameter_start[k + 1]]
        q, v = self.contact(contact)
        return float(planted.law.function(self.time, q, v, self._slip[contact], z, p, np.zeros_like(z)))


class ToldPath(_Path):
    """The bench on its way, with a motion that tells its laws the load."""

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.motion = self._motion = ToldMotion(bench.machine, back_emf=bench.back_emf)


def perform(
    bench: Bench, run: str, sensors: Mapping[str, Sensor], seed: int, watched: Sequence[Planted] = ()
) -> Seen:
    """The experiment ``run`` of ``bench``, as ``sensors`` recorded it; ``watched`` are laws of the machine.

    Raises:
        RigError: if the truth cannot be integrated.
    """
    n = round(bench.duration / bench.dt) + 1
    time = bench.dt * np.arange(n)
    asked = bench.runs[run](time)
    path = ToldPath(bench)
    planted = [one for _, one in bench.machine.planted]
    places = [next(k for k, one in enumerate(planted) if one is law) for law in watched]
    u, y = np.empty(n), np.empty((n, len(bench.outputs)))
    efforts, motion = np.zeros((n, len(places))), np.empty((n, len(bench.contacts), 2))
    measured: list[float] = []
    lags = {name: sensor.lag for name, sensor in sensors.items()}
    for k in range(n):
        y[k] = [sensor.scale * path.read(name, sensor.lag) for name, sensor in sensors.items()]
        motion[k] = [path.motion.contact(c) for c in range(len(bench.contacts))]
        measured.append(path.true_position)
        u[k] = asked[k] if bench.loop is None else bench._command(bench.loop, asked[k], measured)
        path.advance(u[k], lags)
        efforts[k] = [path.motion.effort(place) for place in places]
    generator = np.random.default_rng([seed, list(bench.runs).index(run)])
    y += np.column_stack([sensor.disturbance(n, generator) for sensor in sensors.values()])
    return Seen(
        record=bench.recorded(run, time, u, y, f"drawn league, bench {bench.name}, {run} run, seed {seed}"),
        drive=bench.input_matrix[0][0] * u,
        motion={port: (motion[:, c, 0], motion[:, c, 1]) for c, port in enumerate(bench.contacts)},
        efforts=tuple(efforts.T),
    )
