"""``Rig``: a simulated machine with its experiment, whose truth is known. The base of every virtual rig.

A rig has a reference, a digital controller or source, a drive, sensors and a ``Machine``. It shares no
code with the estimators: it has its own laws, its own integrator and exact dry friction. Every record of a
rig is marked ``simulated``.
"""

from __future__ import annotations

import abc
import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Self, final

import numpy as np
from numpy.typing import NDArray

import hybridid
from hybridid.blame import blamed_on
from hybridid.demand import Demand
from hybridid.records.record import Channel, Record
from hybridid.rigs.laws import RigError, nearest
from hybridid.rigs.truth import PlantedAt, revised

Array = NDArray[np.float64]
_OWN = 20
"""Arrays of the run's length beside those of its channels: its truth, its noise, and what it passes on."""
_SECONDS = 1e-6
"""Of each sample at least."""


@dataclass(frozen=True)
class Experiment:
    """The signals of an experiment on a rig by channel name, each (n,).

    ``inputs``, ``outputs`` and ``auxiliary`` are as recorded. ``truth`` holds signals that no sensor
    measures (true positions, velocities and forces).
    """

    time: Array
    inputs: Mapping[str, Array]
    outputs: Mapping[str, Array]
    auxiliary: Mapping[str, Array] = field(default_factory=dict)
    truth: Mapping[str, Array] = field(default_factory=dict)


class Rig(abc.ABC):
    """A virtual rig. A subclass declares its channels, runs and ports, and writes the experiment.

    ``ports`` are the places where laws can be planted, with the names of the plant's effort ports.
    ``config`` holds all settings of the experiment, a frozen dataclass; its ``truth`` is another, with the
    laws ``planted`` at the ports.
    """

    config: Any
    name: str
    runs: tuple[str, ...]
    ports: tuple[str, ...]
    sampling_time: float
    full_duration: float
    input_channels: tuple[Channel, ...]
    output_channels: tuple[Channel, ...]
    auxiliary_channels: tuple[Channel, ...]

    def __init__(self, config: Any) -> None:
        self.config = config

    @abc.abstractmethod
    def perform(self, run: str, time: Array, generator: np.random.Generator) -> Experiment:
        """Perform the experiment ``run`` at the instants ``time`` (n,) [s], with noise from ``generator``."""

    @abc.abstractmethod
    def summary(self) -> str:
        """The truth in one line, with units."""

    @final
    def with_truth(self, values: Mapping[str, Any], planted: tuple[PlantedAt, ...] | None = None) -> Self:
        """The same rig with another truth: ``values`` by name, and the laws ``planted`` (None: unchanged).

        Raises:
            RigError: in one line for an unknown name or a value that is not allowed.
        """
        truth = revised(self.config.truth, values)
        if planted is not None:
            truth = replace(truth, planted=planted)
        return type(self)(replace(self.config, truth=truth))

    @final
    def configuration(self) -> dict[str, Any]:
        """All settings of the experiment as plain data."""
        plain = asdict(self.config)
        plain["truth"]["planted"] = [one.described() for one in self.config.truth.planted]
        return plain

    @final
    def experiment(
        self, run: str = "identification", seed: int = 0, duration: float | None = None
    ) -> Experiment:
        """Perform the experiment ``run``; the same arguments give the same numbers.

        Raises:
            RigError: for an unknown run, a bad duration or seed, or a truth that diverges.
            OwnCodeError: if a user's own rig fails.
        """
        time = np.arange(self._samples(run, seed, duration), dtype=np.float64) * self.sampling_time
        # each run has its own noise, independent of the order of the runs
        generator = np.random.default_rng([seed, self.runs.index(run)])
        with blamed_on(self, passing=(RigError,)):
            return self.perform(run, time, generator)

    @final
    def demand(self, run: str = "identification", seed: int = 0, duration: float | None = None) -> Demand:
        """What the experiment needs at least.

        Raises:
            RigError: for an unknown run, a bad duration or seed.
        """
        samples = self._samples(run, seed, duration)
        columns = len((*self.input_channels, *self.output_channels, *self.auxiliary_channels))
        keys = ("rig.duration",)
        what = f"the run {run} of rig {self.name}, {samples:.3g} samples,"
        return Demand(what, samples * (columns + _OWN) * 8.0, samples * _SECONDS, keys)

    @final
    def record(self, run: str = "identification", seed: int = 0, duration: float | None = None) -> Record:
        """The experiment as its sensors recorded it, marked ``simulated``.

        ``duration`` [s] shortens or extends the experiment; ``seed`` selects the noise.

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
        """SHA-256 of all that determines the record: configuration, run, seed, samples, program version."""
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
