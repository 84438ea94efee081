"""The package's virtual rigs with a truth drawn at random, and the case's own model of each. Simulated.

The truth lies inside the model: what a case declares is all that the machine does, and only the sensors, dry
friction that truly sticks, and a controller's sampling keep the model off the record.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.rigs.emps import EMPSConfig, EMPSRig, EMPSTruth
from hybridid.rigs.esea import ESEAConfig, ESEARig, ESEATruth
from hybridid.rigs.half_car import HalfCarConfig, HalfCarRig
from hybridid.rigs.half_car_truth import HalfCarTruth
from hybridid.rigs.loop import Encoder
from hybridid.rigs.rig import Rig
from hybridid.rigs.servo import ServoConfig, ServoRig, ServoTruth
from hybridid.rigs.truth import PlantedAt, at
from hybridid.settings.fit import FitSettings
from hybridid.signals.steps import apply_steps
from hybridid_cli.composing import settings_of
from pipelines.shared.config import Settings
from pipelines.shared.modelling import fit_settings, model_of

Generator = np.random.Generator
FINE = Encoder(resolution=2 * np.pi / 2**18, noise_std=3e-4)
"""Of the servo: the counts of its own encoder act on its control, which the model does not contain."""


@dataclass(frozen=True)
class Bench:
    """A rig whose truth is drawn, the ``runs`` to record, and how its case fits them."""

    name: str
    rig: Rig
    runs: tuple[str, ...]
    duration: float | None
    seed: int
    words: tuple[str, ...]
    horizon: int | None = None

    def planted(self, law: PlantedAt) -> Bench:
        """The same bench with one more law at work."""
        return replace(self, rig=self.rig.with_truth({}, (*self.rig.config.truth.planted, law)))

    def recorded(self) -> list[Record]:
        """The runs as the sensors recorded them."""
        return [replace(self.rig.record(run, self.seed, self.duration), name=run) for run in self.runs]

    def prepared(self, records: list[Record]) -> list[Record]:
        """``records`` after the preprocessing of the case."""
        steps = _settings(self.words)["preprocess.steps"]
        return [apply_steps(record, steps) for record in records]

    @property
    def model(self) -> Model:
        """The case's model."""
        return model_of(_settings(self.words))

    @property
    def settings(self) -> FitSettings:
        """The case's own, over ``horizon`` if one is given."""
        own = fit_settings(_settings(self.words))
        return own if self.horizon is None else replace(own, horizon=self.horizon)


@cache
def _settings(words: tuple[str, ...]) -> Settings:
    return settings_of([*words, "data=simulated"])


def carriage(generator: Generator) -> Bench:
    """The EMPS, fitted in free run or over horizons of 1 s."""
    truth = EMPSTruth(
        M=generator.uniform(60.0, 130.0),
        f_v=generator.uniform(120.0, 280.0),
        f_c=generator.uniform(5.0, 35.0),
        offset=generator.uniform(-5.0, 5.0),
    )
    rig = EMPSRig(EMPSConfig(truth=truth))
    horizon = 1000 if generator.random() < 0.5 else None
    return Bench("emps", rig, ("identification",), 10.0, _seed(generator), ("case=emps",), horizon)


def actuator(generator: Generator) -> Bench:
    """The eSEA with viscous friction, or with Coulomb friction and the Stribeck effect."""
    kind = "linear" if generator.random() < 0.5 else "coulomb_stribeck"
    if kind == "linear":
        laws = (at("motor", "viscous", f_v=generator.uniform(0.004, 0.03)),)
    else:
        laws = (
            at("motor", "viscous", f_v=generator.uniform(0.002, 0.008)),
            at("motor", "coulomb", f_c=generator.uniform(0.02, 0.08)),
            at(
                "motor",
                "stribeck",
                amplitude=generator.uniform(0.005, 0.03),
                velocity=generator.uniform(0.6, 2.0),
            ),
        )
    rig = ESEARig(ESEAConfig(truth=ESEATruth(planted=laws)))
    return Bench("esea", rig, ("identification",), None, _seed(generator), ("case=esea", f"friction={kind}"))


def vehicle(generator: Generator) -> Bench:
    """The half-car, its tyres on the road and its speed steady."""
    nominal = HalfCarTruth()
    names = ("I_yy", "k_f", "k_r", "c_f", "c_r", "k_t")
    values = {name: getattr(nominal, name) * 1.4 ** generator.uniform(-1.0, 1.0) for name in names}
    rig = HalfCarRig(HalfCarConfig(truth=HalfCarTruth(**values)))
    return Bench("vehicle", rig, ("identification",), None, _seed(generator), ("case=vehicle",))


def servo(generator: Generator) -> Bench:
    """The servo on three of its trajectories, one of each kind, its friction without the load's part."""
    planted = (
        at("joint", "viscous", f_v=generator.uniform(0.001, 0.006)),
        at("joint", "coulomb", f_c=generator.uniform(0.004, 0.03)),
    )
    truth = ServoTruth(
        J=generator.uniform(0.0012, 0.003),
        k_t=generator.uniform(0.25, 0.4),
        R_s=generator.uniform(0.2, 1.8),
        q_0=generator.uniform(-0.03, 0.03),
        planted=planted,
    )
    gains = generator.choice((100, 200, 400, 800), size=3)
    kinds = ("up_and_down", "sin_sin", "lift_and_drop")
    runs = tuple(f"{kind}_kp{gain}" for kind, gain in zip(kinds, gains, strict=True))
    return Bench(
        "servo",
        ServoRig(ServoConfig(truth=truth, encoder=FINE)),
        runs,
        None,
        _seed(generator),
        ("case=servo",),
    )


def _seed(generator: Generator) -> int:
    return int(generator.integers(2**31))


MACHINES: Mapping[str, Callable[[Generator], Bench]] = {
    "emps": carriage,
    "esea": actuator,
    "vehicle": vehicle,
    "servo": servo,
}
"""Every machine, by the name of its case."""
