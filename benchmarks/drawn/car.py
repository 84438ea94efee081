"""The drawn half-car: the package's rig over a track of random bumps, 6 or 10 s long.

Its drive is the strut itself: the effort that a hidden law is measured against is that of the strut's own
spring and damper.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.drawn.draw import Draw
from benchmarks.drawn.excitation import log_uniform, track
from benchmarks.drawn.told import Seen
from benchmarks.league.machines import RUNS, driven
from hybridid.rigs.half_car import HalfCarConfig, HalfCarRig
from hybridid.rigs.half_car_truth import HalfCarTruth
from hybridid.rigs.rig import Experiment
from hybridid.rigs.truth import PlantedAt

SECONDS = {"long": 10.0, "short": 6.0}
LEVERS = {"front_suspension": ("z_f", -1.5, "k_f", "c_f"), "rear_suspension": ("z_r", 1.6, "k_r", "c_r")}
"""Axle, lever arm from the centre of gravity [m], spring and damper of each strut."""


def perform(draw: Draw, run: str, noise: float, laws: Sequence[PlantedAt]) -> Seen:
    """The run of the car of ``draw`` with ``laws`` planted and white ``noise`` [m/s, rad/s]."""
    own = {name: value for name, value in draw.parameters.items() if name != "speed"}
    truth = HalfCarTruth(**own, planted=tuple(laws))
    generator = np.random.default_rng([draw.seed, 10 + RUNS.index(run)])
    speed = draw.parameters["speed"] * log_uniform(generator, 0.8, 1.2)
    config = HalfCarConfig(
        truth=truth,
        bump=track(generator),  # type: ignore[arg-type]
        identification=speed,
        validation=speed,
    )
    rig = HalfCarRig(config)
    made = rig.experiment(run, draw.seed, SECONDS[draw.kind])
    motion = {port: _strut(made, *LEVERS[port][:2]) for port in LEVERS}
    efforts = [_effort(made.time, motion[one.port], one) for one in laws]
    port = laws[0].port if laws else next(iter(LEVERS))
    source = f"drawn league, half-car over a track of bumps, {run} run, seed {draw.seed} (simulated)"
    record = driven(rig, made, run, noise, draw.seed, source)
    return Seen(record, strut_effort(draw, motion, port), motion, tuple(efforts))


def strut_effort(draw: Draw, motion, port: str):
    """Effort (n,) of the strut's own spring and damper."""
    k, c = (draw.parameters[name] for name in LEVERS[port][2:])
    position, velocity = motion[port]
    return k * position + c * velocity


def _strut(made: Experiment, axle: str, lever: float):
    """Compression (n,) of a strut and its rate; the axle's own rate by central differences."""
    truth, dt = made.truth, made.time[1] - made.time[0]
    position = truth[axle] - truth["z_c"] - lever * truth["theta"]
    velocity = np.gradient(truth[axle], dt) - truth["vertical_velocity"] - lever * truth["pitch_rate"]
    return position, velocity


def _effort(time, motion, one: PlantedAt):
    """Effort (n,) of a law without memory along ``motion``."""
    p, none = np.array([value for _, value in one.what.values]), np.zeros(2)
    law = one.what.law.function
    return np.array(
        [law(t, q, v, np.sign(v), none, p, np.zeros(2)) for t, q, v in zip(time, *motion, strict=True)]
    )
