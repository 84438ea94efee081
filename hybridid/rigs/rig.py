"""``Rig``: a simulated machine with its experiment, whose truth we know. The base of every virtual rig.

A rig owns a reference, a digital controller or source, a drive, sensors and a ``Machine``. It shares no
code with the estimators: other laws, other integrator, true dry friction. What it records says
``simulated`` wherever it goes.
"""

from __future__ import annotations

import abc
import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Self, final

import numpy as np
from numpy.typing import NDArray

import hybridid
from hybridid.records.record import Channel, Record
from hybridid.rigs.laws import RigError, nearest
from hybridid.rigs.truth import PlantedAt

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Experiment:
    """What happened on a rig, by channel name, each (n,): ``inputs``, ``outputs`` and ``auxiliary`` as
    recorded, ``truth`` as only the rig knows it (true positions, velocities and forces)."""

    time: Array
    inputs: Mapping[str, Array]
    outputs: Mapping[str, Array]
    auxiliary: Mapping[str, Array] = field(default_factory=dict)
    truth: Mapping[str, Array] = field(default_factory=dict)


class Rig(abc.ABC):
    """A virtual rig. A subclass declares its channels, runs and ports, and writes the experiment.

    ``ports`` are the places of its machine where laws can be planted, named as the plant's effort ports.
    """

    name: str
    runs: tuple[str, ...]
    ports: tuple[str, ...]
    sampling_time: float
    full_duration: float
    input_channels: tuple[Channel, ...]
    output_channels: tuple[Channel, ...]
    auxiliary_channels: tuple[Channel, ...]

    @abc.abstractmethod
    def perform(self, run: str, time: Array, generator: np.random.Generator) -> Experiment:
        """The experiment ``run`` at the instants ``time`` (n,) [s], noise drawn from ``generator``."""

    @abc.abstractmethod
    def with_truth(self, values: Mapping[str, Any], planted: tuple[PlantedAt, ...] | None = None) -> Self:
        """The same rig with another truth: ``values`` by name, and ``planted`` instead of what is planted
        (None: as it is).

        Raises:
            RigError: in one line for an unknown name or a value that cannot be.
        """

    @abc.abstractmethod
    def configuration(self) -> Mapping[str, Any]:
        """Everything that decides the experiment, as plain data."""

    @abc.abstractmethod
    def summary(self) -> str:
        """The truth in one line, with units."""

    @final
    def experiment(
        self, run: str = "identification", seed: int = 0, duration: float | None = None
    ) -> Experiment:
        """Repeats an experiment; the same arguments give the same numbers.

        Raises:
            RigError: for an unknown run, a bad duration or seed, or a truth that diverges.
        """
        time = np.arange(self._samples(run, seed, duration), dtype=np.float64) * self.sampling_time
        # Each run has its own noise, whatever order the runs are made in.
        generator = np.random.default_rng([seed, self.runs.index(run)])
        return self.perform(run, time, generator)

    @final
    def record(self, run: str = "identification", seed: int = 0, duration: float | None = None) -> Record:
        """The experiment as its sensors recorded it, marked ``simulated``.

        ``duration`` [s] cuts the experiment short or goes on with it; ``seed`` chooses the noise.

        Raises:
            RigError: see ``experiment``.
        """
        made = self.experiment(run, seed, duration)
        return Record(
            name=f"{self.name}_rig_{run}",
            time=made.time,
            inputs=_columns(made.inputs, self.input_channels),
            outputs=_columns(made.outputs, self.output_channels),
            input_channels=self.input_channels,
            output_channels=self.output_channels,
            auxiliary=_columns(made.auxiliary, self.auxiliary_channels) if self.auxiliary_channels else None,
            auxiliary_channels=self.auxiliary_channels,
            simulated=True,
            source=f"virtual rig {self.name}, {run} run, seed {seed} (simulated): {self.summary()}",
            digest=self.digest(run, seed, duration),
        )

    @final
    def digest(self, run: str = "identification", seed: int = 0, duration: float | None = None) -> str:
        """SHA-256 of all that decides the record: configuration, run, seed, samples, program version."""
        said = {
            "rig": self.name,
            "version": hybridid.__version__,
            "run": run,
            "seed": seed,
            "samples": self._samples(run, seed, duration),
            "configuration": self.configuration(),
        }
        return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()

    def _samples(self, run: str, seed: int, duration: float | None) -> int:
        if run not in self.runs:
            raise RigError(f"rig {self.name}: no run {run!r}{nearest(run, list(self.runs))}")
        if not isinstance(seed, int) or seed < 0:
            raise RigError(f"rig {self.name}: seed is {seed!r}, must be a whole number, 0 or more")
        length = self.full_duration if duration is None else duration
        shortest = 10 * self.sampling_time
        if not (math.isfinite(length) and length >= shortest):
            raise RigError(f"rig {self.name}: duration is {length:g} s, must be {shortest:g} s or more")
        return round(length / self.sampling_time) + 1


def _columns(signals: Mapping[str, Array], channels: tuple[Channel, ...]) -> Array:
    """Signals side by side in the order of their channels, (n, n_channels)."""
    return np.column_stack([signals[channel.name] for channel in channels])
