"""Planted load friction on two rigs of the package: the virtual EMPS and the servo with its pendulum.

    F = mu |drive - load| sign(v),    mu = share RMS(drive) / RMS(drive - load)

along the motion without it. White noise is added to what the rig's own encoder reads, so that no controller
reads it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from benchmarks.drawn.recipes import rms
from benchmarks.league.machines import RUNS
from benchmarks.rebuilt.draw import Draw
from hybridid.records.record import Record
from hybridid.rigs.emps import EMPSConfig, EMPSRig, EMPSTruth
from hybridid.rigs.servo import GRAVITY, ServoConfig, ServoRig, ServoTruth
from hybridid.rigs.truth import at

SECONDS = {"emps_rig": 10.0, "servo_rig": 6.0}
SWINGS = dict(zip(RUNS, ("sin_sin_kp400", "sin_sin_kp200"), strict=True))
"""Of the servo: one trajectory under two gains."""


def record(draw: Draw, run: str, noise: float, amounts: Mapping[str, float]) -> Record:
    """The run of the rig of ``draw`` with ``amounts`` of what is hidden (none: nothing)."""
    rig = _emps(draw, amounts) if draw.machine == "emps_rig" else _servo(draw, amounts)
    made = rig.record(run if draw.machine == "emps_rig" else SWINGS[run], draw.seed, SECONDS[draw.machine])
    generator = np.random.default_rng([draw.seed, RUNS.index(run)])
    return replace(made, outputs=made.outputs + noise * generator.standard_normal(made.outputs.shape))


def _emps(draw: Draw, amounts: Mapping[str, float]) -> EMPSRig:
    planted = (at("carriage", "load_friction", mu=amounts["share"]),) if amounts else ()
    return EMPSRig(EMPSConfig(truth=EMPSTruth(**draw.parameters, planted=planted)))


def _servo(draw: Draw, amounts: Mapping[str, float]) -> ServoRig:
    p = draw.parameters
    own = at("joint", "viscous", f_v=p["f_v"]), at("joint", "coulomb", f_c=p["f_c"])
    truth = ServoTruth(J=p["J"], k_t=p["k_t"], R_s=p["R_s"], planted=own)
    if amounts:
        mu = amounts["share"] * _drive_over_carried(truth, draw)
        truth = replace(truth, planted=(*own, at("joint", "load_friction", mu=mu)))
    return ServoRig(ServoConfig(truth=truth))


def _drive_over_carried(truth: ServoTruth, draw: Draw) -> float:
    """``RMS(drive) / RMS(drive - load)`` in the run to fit."""
    config = ServoConfig(truth=truth)
    seen = ServoRig(config).experiment(SWINGS[RUNS[0]], draw.seed, SECONDS["servo_rig"])
    velocities = zip(seen.auxiliary["duty"], seen.truth["velocity"], strict=True)
    drive = np.array([truth.torque(duty, config.supply, v) for duty, v in velocities])
    return rms(drive) / rms(drive + truth.m * GRAVITY * truth.l * np.sin(seen.truth["position"]))
