"""The virtual eSEA: a motor turns a link through a rubber joint, in a PD position loop (thesis, Chapter 5).

    J delta'' = torque on the shaft - F_motor - K_e (delta - theta) - F_elastomer
    I theta'' = K_e (delta - theta) + F_elastomer - F_link
    torque = saturated(kp e + kd e'),  e = reference - delta,  held over 2 ms

As on the bench: linear swept sines, 500 Hz, encoders of 8192 counts on motor and link, 1.99 N·m at most.
The thesis gives neither the gains of the loop, nor the amplitudes and length of its sweeps, nor its
differentiator; these are our choice. The loop is closed on the motor's encoder (closed on the link's, it
would make the joint's mode unstable). The sweeps last 10 s. With their amplitudes, the link velocity has the
variance that the thesis' MSE and R² imply: 32.9 rad²/s² (Table 5.4) and 17.9 rad²/s² (one of the two values
that Table 5.5 implies).

Source: thesis Eqs. 5-1 to 5-4, Sections 5.2 and 5.2.1, Table 5.1.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from hybridid.records.record import Channel
from hybridid.rigs.law_library import STIFFNESS
from hybridid.rigs.laws import Planted, RigError
from hybridid.rigs.loop import PD, Drive, Encoder
from hybridid.rigs.machine import Machine, Motion
from hybridid.rigs.rig import Experiment, Rig
from hybridid.rigs.sweep import LinearSweep, VelocityFilter
from hybridid.rigs.truth import PlantedAt, at

Array = NDArray[np.float64]
PORTS = ("motor", "elastomer", "link")
TOLERANCE = 1e-8  # of a step of the truth; an encoder counts 8e-4 rad
DIRECTIONS = ((1.0, 0.0), (1.0, -1.0), (0.0, 1.0))  # of (delta, theta), port by port


@dataclass(frozen=True)
class ESEATruth:
    """Inertias I of the link and J of the motor [kg m^2], K_e [N m/rad]; friction and all else is planted.

    The torque on the shaft is ``torque_gain`` times the recorded torque plus ``torque_offset`` [N m]: errors
    of the torque constant and of the current sensor.
    """

    I: float = 0.0014  # noqa: E741
    J: float = 0.0001
    K_e: float = 8.459
    torque_gain: float = 1.0
    torque_offset: float = 0.0
    planted: tuple[PlantedAt, ...] = ()

    def __post_init__(self) -> None:
        if not (min(self.I, self.J) > 0 and self.K_e >= 0):
            inertias = f"I is {self.I:g} kg m^2, J {self.J:g} kg m^2 (above 0)"
            raise RigError(f"eSEA rig: {inertias}, K_e {self.K_e:g} N m/rad (not below 0)")
        self.machine  # noqa: B018 - its own check

    @property
    def machine(self) -> Machine:
        """Motor and link: two inertias, and a contact for each port."""
        own: dict[str, tuple[Planted, ...]] = {"elastomer": (STIFFNESS(k=self.K_e, q_0=0.0),)}
        for one in self.planted:
            own[one.port] = (*own.get(one.port, ()), one.what)
        laws = tuple(own.get(port, ()) for port in PORTS)
        return Machine(((self.J, 0.0), (0.0, self.I)), ((1.0,), (0.0,)), DIRECTIONS, laws)


# The thesis' own numbers (Table 5.2) cannot be read. These make friction a tenth of the largest torque.
F_V, F_C, F_S, V_S, SIGMA_0, SIGMA_1 = 0.004, 0.045, 0.06, 1.0, 9.0, 0.01
FRICTIONS: Mapping[str, tuple[PlantedAt, ...]] = {
    "linear": (at("motor", "viscous", f_v=0.01),),
    "coulomb_stribeck": (
        at("motor", "viscous", f_v=F_V),
        at("motor", "coulomb", f_c=F_C),
        at("motor", "stribeck", amplitude=F_S - F_C, velocity=V_S),
    ),
    "dahl": (at("motor", "dahl", amplitude=F_C, stiffness=SIGMA_0),),
    "lugre": (
        at("motor", "viscous", f_v=F_V),
        at("motor", "lugre", f_c=F_C, f_s=F_S, v_s=V_S, sigma_0=SIGMA_0, sigma_1=SIGMA_1),
    ),
}
"""The laws of a truth without undeclared effects, by the name of the friction (thesis Eqs. 5-5 to 5-10)."""
# What no declared model contains: rubber that stiffens, creeps and dissipates, friction in the link's
# bearing, a misaligned shaft, an error of the torque constant.
UNDECLARED = (
    at("motor", "cogging", amplitude=0.06, pitch=2 * math.pi, phase=0.3),
    at("elastomer", "cubic_stiffness", k_3=300.0, q_0=0.0),
    at("elastomer", "maxwell", k=6.0, tau=0.03),
    at("elastomer", "viscous", f_v=0.003),
    at("link", "coulomb", f_c=0.006),
)
DEFAULT = ESEATruth(torque_gain=0.95, torque_offset=0.003, planted=(*FRICTIONS["lugre"], *UNDECLARED))
CONTROLLER = PD(kp=3.0, kd=0.05)
DRIVE = Drive(gain=1.0, saturation=1.99)
ENCODER = Encoder(resolution=2 * math.pi / 8192, noise_std=2e-4)
VELOCITY = VelocityFilter(window=5, degree=4)
IDENTIFICATION = LinearSweep(amplitude=0.323, first=0.1, last=5.0, duration=10.0)
VALIDATION = LinearSweep(amplitude=0.401, first=0.1, last=3.5, duration=10.0, phase=math.pi)


@dataclass(frozen=True)
class ESEAConfig:
    """All settings of an experiment on the virtual eSEA, in SI units."""

    truth: ESEATruth = DEFAULT
    controller: PD = CONTROLLER
    drive: Drive = DRIVE
    encoder: Encoder = ENCODER
    velocity: VelocityFilter = VELOCITY
    identification: LinearSweep = IDENTIFICATION
    validation: LinearSweep = VALIDATION


@final
class ESEARig(Rig):
    """The elastomer-based series elastic actuator, simulated.

    Runs: ``identification``, and ``validation`` with a slower sweep of another amplitude that starts in the
    other direction.
    """

    config: ESEAConfig
    name = "esea"
    runs = ("identification", "validation")
    ports = PORTS
    sampling_time = 2e-3
    full_duration = 10.0
    input_channels = (Channel("torque", "N·m", "zoh", "motor torque, as commanded"),)
    output_channels = (Channel("link_velocity", "rad/s", meaning="link angular velocity, from its encoder"),)
    auxiliary_channels = (
        Channel("reference", "rad", meaning="commanded angle"),
        Channel("motor_angle", "rad", meaning="motor encoder"),
        Channel("link_angle", "rad", meaning="link encoder"),
    )

    def __init__(self, config: ESEAConfig | None = None) -> None:
        super().__init__(config or ESEAConfig())

    def summary(self) -> str:
        truth = self.config.truth
        planted = ", ".join(one.said(turns=True) for one in truth.planted) or "nothing"
        return (
            f"I {truth.I:g} kg m^2, J {truth.J:g} kg m^2, K_e {truth.K_e:g} N m/rad, torque on the shaft "
            f"{truth.torque_gain:g} of the recorded and {truth.torque_offset:g} N m, planted: {planted}"
        )

    def perform(self, run: str, time: Array, generator: np.random.Generator) -> Experiment:
        config, n, dt = self.config, len(time), self.sampling_time
        reach = config.velocity.reach  # the bench rests before the record, and runs on briefly after it
        reference = getattr(config, run).position(dt * np.arange(n + reach))
        motor_noise, link_noise = (config.encoder.noise(n + 2 * reach, part) for part in generator.spawn(2))
        motion = Motion(config.truth.machine, positions=[0.0, 0.0], tolerance=TOLERANCE)
        torque, motor = np.empty(n + reach), np.empty(n + reach)
        angles, velocities = np.zeros((n + 2 * reach, 2)), np.zeros((n + 2 * reach, 2))
        error = previous = 0.0
        for k in range(n + reach):
            angles[reach + k], velocities[reach + k] = motion.positions, motion.velocities
            motor[k] = config.encoder.read(angles[reach + k, 0] + motor_noise[k])
            previous, error = error, reference[k] - motor[k]
            torque[k] = config.drive.voltage(config.controller.command(error, previous, dt))
            motion.advance(dt, self._on_shaft(torque[k : k + 1]))
        link = np.array([config.encoder.read(angle) for angle in angles[:, 1] + link_noise])
        kept = slice(reach, reach + n)
        return Experiment(
            time,
            inputs={"torque": torque[:n]},
            outputs={"link_velocity": config.velocity(link, dt)},
            auxiliary={"reference": reference[:n], "motor_angle": motor[:n], "link_angle": link[kept]},
            truth={
                "motor_angle": angles[kept, 0],
                "link_angle": angles[kept, 1],
                "motor_velocity": velocities[kept, 0],
                "link_velocity": velocities[kept, 1],
            },
        )

    def _on_shaft(self, torque: Array) -> Array:
        truth = self.config.truth
        return truth.torque_gain * torque + truth.torque_offset


def _as_declared(friction: str) -> ESEARig:
    return ESEARig(ESEAConfig(truth=ESEATruth(planted=FRICTIONS[friction])))


AS_DECLARED_LINEAR = _as_declared("linear")
AS_DECLARED_COULOMB_STRIBECK = _as_declared("coulomb_stribeck")
AS_DECLARED_DAHL = _as_declared("dahl")
AS_DECLARED_LUGRE = _as_declared("lugre")
