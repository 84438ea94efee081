"""The virtual EMPS: a carriage on a ball screw under a cascaded PD, as Janot, Gautier and Brunot ran it.

    M q'' = force - f_v q' - f_c sign(q') - offset - planted effects
    force = gain * saturated(kp kv (reference - position) - kv velocity + pulses),  held over 1 ms

The rig repeats what the measured records show: the command depends on the position of its own
sample (no delay), one encoder count is 5e-8 m, and the recorded voltage contains the pulses of the
validation run.

Source: Janot, Gautier, Brunot (2019), "Data set and reference models of EMPS".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from hybridid.records.record import Channel
from hybridid.rigs.law_library import COULOMB, OFFSET, VISCOUS
from hybridid.rigs.laws import RigError
from hybridid.rigs.loop import CascadedPD, Drive, Encoder
from hybridid.rigs.machine import Machine, Motion
from hybridid.rigs.rig import Experiment, Rig
from hybridid.rigs.trajectory import BangBang, Move
from hybridid.rigs.truth import PlantedAt, at

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EMPSTruth:
    """``M q'' = force - f_v q' - f_c sign(q') - offset - planted``; M [kg], f_v [N s/m], f_c, offset [N].

    ``planted`` are further effects of the carriage, which the declared model does not contain.
    """

    M: float = 95.0
    f_v: float = 203.0
    f_c: float = 20.4
    offset: float = -3.2
    planted: tuple[PlantedAt, ...] = ()

    def __post_init__(self) -> None:
        if not self.M > 0 or self.f_c < 0:
            raise RigError(f"EMPS rig: M is {self.M:g} kg (above 0), f_c {self.f_c:g} N (not below 0)")

    @property
    def machine(self) -> Machine:
        """The carriage: one mass, one contact."""
        believed = (VISCOUS(f_v=self.f_v), COULOMB(f_c=self.f_c), OFFSET(offset=self.offset))
        laws = (*believed, *(one.what for one in self.planted))
        return Machine(((self.M,),), ((1.0,),), ((1.0,),), (laws,))


@dataclass(frozen=True)
class SquareWave:
    """A voltage that alternates between 0 and ``height`` [V], ``samples`` samples each, 0 first."""

    height: float = 5.0
    samples: int = 500

    def __post_init__(self) -> None:
        if self.samples < 1:
            raise RigError(f"{self}: samples must be 1 or more")

    def __call__(self, n: int) -> Array:
        high = np.arange(n) // self.samples % 2 == 1
        return np.where(high, self.height, 0.0)


CONTROLLER = CascadedPD(kp=160.18, kv=243.45)
DRIVE = Drive(gain=35.15, saturation=10.0)
ENCODER = Encoder(resolution=5e-8, noise_std=1e-8)
PULSES = SquareWave()
# Speeds, accelerations and stroke are those of the measured reference, the moves are ours: a quick move in
# both directions comes first, so that a short record has both.
REFERENCE = BangBang(
    lead_in=0.1,
    moves=(
        Move(0.017, 0.042, 0.84),
        Move(0.0, 0.042, 0.84),
        Move(0.065, 0.083, 0.84),
        Move(0.2125, 0.125, 0.84, rest=0.1),
        Move(0.245, 0.083, 0.6),
        Move(0.0975, 0.125, 0.84),
        Move(0.0325, 0.083, 0.6),
        Move(0.0, 0.042, 0.84, rest=0.1),
    ),
)


@dataclass(frozen=True)
class EMPSConfig:
    """All settings of an experiment on the virtual EMPS, in SI units."""

    truth: EMPSTruth = EMPSTruth()
    controller: CascadedPD = CONTROLLER
    drive: Drive = DRIVE
    encoder: Encoder = ENCODER
    reference: BangBang = REFERENCE
    pulses: SquareWave = PULSES


# The real machine with the authors' values for each direction (f_v 166.706 and 240.424 N s/m, f_c 20.144 and
# 20.628 N). The asymmetry of the worn screw is planted, since the symmetric model does not contain it. The
# offset of -3.2 N that a fit of the symmetric model gives is not in the truth: the asymmetry causes it.
DEFAULT = EMPSConfig(
    truth=EMPSTruth(
        M=95.154,
        f_v=203.565,
        f_c=20.386,
        offset=-0.242,
        planted=(at("carriage", "asymmetric_viscous", difference=73.718),),
    )
)


@final
class EMPSRig(Rig):
    """The electro-mechanical positioning system, simulated. Runs: ``identification`` and, with pulses
    on the command, ``validation``."""

    config: EMPSConfig
    name = "emps"
    runs = ("identification", "validation")
    ports = ("carriage",)
    sampling_time = 1e-3
    full_duration = 24.84
    input_channels = (Channel("force", "N", "zoh", "motor force on the load side"),)
    output_channels = (Channel("position", "m", meaning="carriage position"),)
    auxiliary_channels = (
        Channel("reference", "m", meaning="commanded position"),
        Channel("pulses", "V", meaning="added to the controller's voltage"),
    )

    def __init__(self, config: EMPSConfig = DEFAULT) -> None:
        super().__init__(config)

    def summary(self) -> str:
        truth = self.config.truth
        planted = ", ".join(one.said() for one in truth.planted) or "nothing"
        return (
            f"M {truth.M:g} kg, f_v {truth.f_v:g} N s/m, f_c {truth.f_c:g} N, offset {truth.offset:g} N, "
            f"planted: {planted}"
        )

    def perform(self, run: str, time: Array, generator: np.random.Generator) -> Experiment:
        config, n, dt = self.config, len(time), self.sampling_time
        reference = config.reference.position(time)
        pulses = config.pulses(n) if run == "validation" else np.zeros(n)
        noise = config.encoder.noise(n, generator)
        motion = Motion(config.truth.machine, positions=[0.0])
        measured, force, position, velocity = (np.empty(n) for _ in range(4))
        previous = oldest = config.encoder.read(0.0)
        for k in range(n):
            position[k], velocity[k] = motion.positions[0], motion.velocities[0]
            measured[k] = config.encoder.read(position[k] + noise[k])
            command = config.controller.command(reference[k], (measured[k], previous, oldest), dt)
            force[k] = config.drive.gain * config.drive.voltage(command + pulses[k])
            motion.advance(dt, force[k : k + 1])
            previous, oldest = measured[k], previous
        return Experiment(
            time,
            inputs={"force": force},
            outputs={"position": measured},
            auxiliary={"reference": reference, "pulses": pulses},
            truth={"position": position, "velocity": velocity},
        )
