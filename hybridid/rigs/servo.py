"""The virtual servo: a geared motor under its firmware's position control swings a pendulum.

    (J + m l²) q'' = tau - m g l sin(q) - planted frictions
    duty = clip(kp e (goal - measured), -1, 1),  e = 4096 / (2 pi 256 885) 1/rad
    tau  = enabled k_t (supply duty - k_t q') / (R - R_s (1 - duty²)),  anew each millisecond

As in the publishers' recordings: three kinds of trajectory of 6 s, gains of 100 to 800, an encoder of 4096
counts a turn. ``up_and_down`` rises to a right angle in 3 s and sinks by a fifth of it in 3 s; ``sin_sin`` is
(pi/2) sin t + 0.5 sin 5t sin 2t; ``lift_and_drop`` lifts to a right angle in 2 s, then the torque goes off.

Source: Duclusaud, Passault, Padois, Ly (2025), IEEE ICRA, arXiv:2410.08650; the goals of their recordings.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from hybridid.records.record import Channel
from hybridid.rigs.laws import RigError
from hybridid.rigs.load_laws import WEIGHT
from hybridid.rigs.loop import Encoder
from hybridid.rigs.machine import Machine, Motion
from hybridid.rigs.rig import Experiment, Rig
from hybridid.rigs.truth import PlantedAt, at

Array = NDArray[np.float64]
COUNTS = 4096
"""Encoder counts of a turn."""
DUTY = COUNTS / (2 * math.pi * 256 * 885)
"""Duty for a gain of 1 and an error of 1 rad [1/rad]."""
GRAVITY = 9.80665
TICK = 1e-3
"""Seconds between two updates of the motor's torque."""
TOLERANCE = 1e-8
"""Of a step of the truth; an encoder counts 1.5e-3 rad."""


@dataclass(frozen=True)
class ServoTruth:
    """Bob m [kg] at l [m]; J [kg m^2] and k_t [N m/A] at the output; R, R_s [ohm]; zero q_0 [rad].

    All friction is planted.
    """

    m: float = 0.49
    l: float = 0.1  # noqa: E741
    J: float = 0.0018
    k_t: float = 0.3
    R: float = 3.4
    R_s: float = 1.0
    q_0: float = -0.015
    planted: tuple[PlantedAt, ...] = ()

    def __post_init__(self) -> None:
        if not (min(self.m, self.l, self.J, self.k_t) > 0 and 0 <= self.R_s < self.R):
            raise RigError(
                f"servo rig: m {self.m:g} kg, l {self.l:g} m, J {self.J:g} kg m^2, k_t {self.k_t:g} N m/A "
                f"must be above 0, R_s {self.R_s:g} ohm not below 0 and below R {self.R:g} ohm"
            )

    @property
    def machine(self) -> Machine:
        """One inertia, one contact: the gear, which the weight loads."""
        weight = WEIGHT(amplitude=self.m * GRAVITY * self.l, q_0=0.0)
        laws = (weight, *(one.what for one in self.planted))
        return Machine(((self.J + self.m * self.l**2,),), ((1.0,),), ((1.0,),), (laws,))

    def torque(self, duty: float, supply: float, velocity: float) -> float:
        """What the motor gives at the output shaft [N m] at a velocity [rad/s]."""
        resistance = self.R - self.R_s * (1.0 - duty * duty)
        return self.k_t * (supply * duty - self.k_t * velocity) / resistance


def _smooth(share: Array) -> Array:
    """0 before 0, 1 after 1, a cubic with flat ends between."""
    inside = np.clip(share, 0.0, 1.0)
    return inside**2 * (3.0 - 2.0 * inside)


def _up_and_down(time: Array) -> Array:
    return 0.5 * np.pi * (_smooth(time / 3.0) - 0.2 * _smooth(time / 3.0 - 1.0))


def _sin_sin(time: Array) -> Array:
    return 0.5 * np.pi * np.sin(time) + 0.5 * np.sin(5.0 * time) * np.sin(2.0 * time)


def _lift_and_drop(time: Array) -> Array:
    return -0.5 * np.pi * _smooth(time / 2.0)


GOALS: Mapping[str, Callable[[Array], Array]] = {
    "up_and_down": _up_and_down,
    "sin_sin": _sin_sin,
    "lift_and_drop": _lift_and_drop,
}
DROP = 2.0
"""Seconds until ``lift_and_drop`` switches the torque off."""
GAINS = (100, 200, 400, 800)
FRICTIONS = (
    at("joint", "viscous", f_v=0.003),
    at("joint", "coulomb", f_c=0.01),
    at("joint", "load_friction", mu=0.2),
)


ENCODER = Encoder(resolution=2 * math.pi / COUNTS, noise_std=3e-4)


@dataclass(frozen=True)
class ServoConfig:
    """All settings of an experiment on the virtual servo, in SI units."""

    truth: ServoTruth = ServoTruth(planted=FRICTIONS)
    encoder: Encoder = ENCODER
    supply: float = 7.4


@final
class ServoRig(Rig):
    """The servo with its pendulum, simulated. Its own truth has friction in proportion to the load.

    Runs: each kind of trajectory with each gain, as ``sin_sin_kp400``.
    """

    config: ServoConfig
    name = "servo"
    runs = tuple(f"{kind}_kp{gain}" for kind in GOALS for gain in GAINS)
    ports = ("joint",)
    sampling_time = 5e-3
    full_duration = 6.0
    input_channels = (
        Channel("goal", "rad", "zoh", "commanded angle"),
        Channel("kp", "1", "zoh", "gain of the firmware"),
        Channel("supply", "V", "zoh", "supply voltage"),
        Channel("enabled", "1", "zoh", "torque on or off"),
    )
    output_channels = (Channel("position", "rad", meaning="angle of the output shaft"),)
    auxiliary_channels = (Channel("duty", "1", meaning="duty of the bridge"),)

    def __init__(self, config: ServoConfig | None = None) -> None:
        super().__init__(config or ServoConfig())

    def summary(self) -> str:
        truth = self.config.truth
        planted = ", ".join(one.said(turns=True) for one in truth.planted) or "nothing"
        return (
            f"m {truth.m:g} kg, l {truth.l:g} m, J {truth.J:g} kg m^2, k_t {truth.k_t:g} N m/A, "
            f"R {truth.R:g} ohm, R_s {truth.R_s:g} ohm, q_0 {truth.q_0:g} rad, planted: {planted}"
        )

    def perform(self, run: str, time: Array, generator: np.random.Generator) -> Experiment:
        config, n = self.config, len(time)
        kind, _, gain = run.rpartition("_kp")
        goal, kp = GOALS[kind](time), float(gain)
        enabled = np.where((kind == "lift_and_drop") & (time >= DROP), 0.0, 1.0)
        noise = config.encoder.noise(n, generator)
        motion = Motion(config.truth.machine, positions=[0.0], tolerance=TOLERANCE)
        measured, duty, position, velocity = (np.empty(n) for _ in range(4))
        for k in range(n):
            position[k], velocity[k] = motion.positions[0], motion.velocities[0]
            measured[k] = config.encoder.read(position[k] + config.truth.q_0 + noise[k])
            duty[k] = self._duty(kp, goal[k], position[k])
            for _ in range(round(self.sampling_time / TICK)):
                motion.advance(TICK, enabled[k] * self._torque(kp, goal[k], motion))
        return Experiment(
            time,
            inputs={
                "goal": goal,
                "kp": np.full(n, kp),
                "supply": np.full(n, config.supply),
                "enabled": enabled,
            },
            outputs={"position": measured},
            auxiliary={"duty": duty * enabled},
            truth={"position": position, "velocity": velocity},
        )

    def _duty(self, kp: float, goal: float, position: float) -> float:
        error = goal - self.config.encoder.read(position + self.config.truth.q_0)
        return min(max(kp * DUTY * error, -1.0), 1.0)

    def _torque(self, kp: float, goal: float, motion: Motion) -> Array:
        duty = self._duty(kp, goal, motion.positions[0])
        return np.array([self.config.truth.torque(duty, self.config.supply, motion.velocities[0])])
