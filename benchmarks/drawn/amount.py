"""From what was wanted to what is hidden: the amount that takes the wanted share of the drive's effort.

    share = RMS(effort of the hidden law) / RMS(effort of the drive),    in the run to fit

both along the true motion with the law at work, by the rig's own code. A few simulations find the amount:
each multiplies it by wanted over found, or halves it where the machine stands still or runs away. Where the
share cannot be reached (a law that eases friction may not push; friction that would hold the machine), what
is nearest stays, and ``Made.share`` says what it takes.

The drive's dead zone and saturation take their share of its command, by at most ``MOST_OF_PATH``; delays and
lags are log-uniform from half a sample to four. These are measured without the law at work.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from benchmarks.drawn import car
from benchmarks.drawn.draw import Draw, Wanted, draw_of
from benchmarks.drawn.excitation import between
from benchmarks.drawn.hidden import Concealed, concealed
from benchmarks.drawn.machines import bench_of, viscous_at
from benchmarks.drawn.offers import LATE
from benchmarks.drawn.recipes import Moving, rms
from benchmarks.drawn.told import Seen, perform
from benchmarks.league.bench import Drive, Sensor
from benchmarks.league.machines import RUNS
from hybridid.records.record import Record
from hybridid.rigs.laws import RigError

Array = NDArray[np.float64]
ROUNDS, NEAR = 8, 0.03
MOST_OF_PATH = 0.3
HELD = 0.2
"""A port that moves less than this share of its motion without the law, or more than its inverse, is lost."""


@dataclass(frozen=True)
class Made:
    """What is hidden, and the share of the drive's RMS effort that it takes (NaN of a delay or a lag)."""

    hidden: tuple[Concealed, ...]
    share: float


def simulated(draw: Draw, hidden: Sequence[Concealed], run: str, noise: float) -> Seen:
    """The run of the machine of ``draw`` with ``hidden`` at work.

    Raises:
        RigError: if the truth cannot be integrated.
    """
    if draw.machine == "half_car":
        return car.perform(draw, run, noise, [one.planted for one in hidden])
    bench, lag, laws = bench_of(draw), 0.0, []
    for one in hidden:
        if one.what == "sensor_lag":
            lag = one.values["lag"]
        elif one.on_path:
            bench = replace(bench, drive=Drive(**one.values))
        else:
            laws.append(one.planted.what)
            planted = (*bench.planted.get(one.port, ()), laws[-1])
            bench = replace(bench, planted={**bench.planted, one.port: planted})
    sensors = dict.fromkeys(bench.outputs, Sensor(noise, lag=lag))
    return perform(bench, run, sensors, draw.seed, laws)


@cache
def made(number: int) -> Made:
    """What scenario ``number`` hides."""
    draw = draw_of(number)
    wanted = draw.wanted
    if wanted is None:
        return Made((), 0.0)
    plain, other = (simulated(draw, (), run, 0.0) for run in RUNS)
    if wanted.what in LATE:
        value = between(wanted.chances[0], 0.5, 4.0) * plain.record.dt
        return Made((Concealed(wanted.what, wanted.ports[0], {LATE[wanted.what]: value}),), math.nan)
    if wanted.what in ("input_dead_zone", "input_saturation"):
        return of_drive(wanted, plain)
    moving = [_moving(draw, plain, port) for port in wanted.ports]
    spreads = [
        [seen.motion[port][0].std() for port in wanted.ports if port in seen.motion]
        for seen in (plain, other)
    ]
    return _at_ports(draw, wanted, moving, np.array(spreads))


def _moving(draw: Draw, plain: Seen, port: str) -> Moving:
    effort = car.strut_effort(draw, plain.motion, port) if draw.machine == "half_car" else plain.drive
    position, velocity = plain.motion.get(port) or next(iter(plain.motion.values()))
    viscous = 0.0 if port not in plain.motion else viscous_at(draw, port)
    return Moving.of(position, velocity, effort, plain.record.dt, viscous)


def of_drive(wanted: Wanted, plain: Seen) -> Made:
    """A dead zone or a limit of the drive that takes the share of the command in the run without it."""
    u = plain.record.inputs[:, 0]
    name = {"input_dead_zone": "dead_zone", "input_saturation": "limit"}[wanted.what]
    share = min(wanted.share, MOST_OF_PATH)

    def taken(value: float) -> float:
        passed = Drive(**{name: value})
        return rms(u - np.array([passed.passed(x) for x in u])) / rms(u)

    peak = float(np.abs(u).max())
    value = float(brentq(lambda x: taken(x) - share, 1e-6 * peak, peak))
    return Made((Concealed(wanted.what, wanted.ports[0], {name: value}),), taken(value))


def _at_ports(draw: Draw, wanted: Wanted, moving: Sequence[Moving], spreads: Array) -> Made:
    """``spreads`` (runs, ports): how far each port moves without the law."""
    amounts = [wanted.share * at.effort for at in moving]
    most = [math.inf for _ in amounts]
    best: tuple[float, Made] | None = None
    for _ in range(ROUNDS):
        hidden = tuple(
            concealed(draw, wanted, port, a, at)
            for port, a, at in zip(wanted.ports, amounts, moving, strict=True)
        )
        try:
            found = _shares(draw, hidden, spreads)
        except RigError:
            most, amounts = amounts, [a / 2 for a in amounts]
            continue
        off = max(abs(math.log(max(share, 1e-9) / wanted.share)) for share in found)
        if best is None or off < best[0]:
            best = off, Made(hidden, float(np.mean(found)))
        if off < NEAR:
            break
        ratios = [min(max(wanted.share / max(share, 1e-9), 0.2), 5.0) for share in found]
        amounts = [min(a * r, (a + m) / 2) for a, r, m in zip(amounts, ratios, most, strict=True)]
    if best is None:
        raise RigError(f"drawn scenario {draw.key}: no amount of {wanted.what} can be simulated")
    return best[1]


def _shares(draw: Draw, hidden: Sequence[Concealed], spreads: Array) -> list[float]:
    """Of each law in the run to fit, along the motion with all at work.

    Raises:
        RigError: if the truth diverges, or in either run a port is all but held or runs away.
    """
    seen, other = (simulated(draw, hidden, run, 0.0) for run in RUNS)
    ports = [one.port for one in hidden if not one.on_path]
    moved = np.array([[each.motion[port][0].std() for port in ports] for each in (seen, other)])
    if not np.all((HELD * spreads < moved) & (moved < spreads / HELD)):
        raise RigError(f"drawn scenario {draw.key}: a port is held, or runs away")
    if hidden[0].what == "input_gain":
        return [abs(1 - hidden[0].values["gain"])]
    if draw.machine == "half_car":
        drives = [car.strut_effort(draw, seen.motion, one.port) for one in hidden]
    else:
        drives = [seen.drive for _ in hidden]
    return [rms(effort) / rms(drive) for effort, drive in zip(seen.efforts, drives, strict=True)]


def records_of(draw: Draw, quiet: bool = False, empty: bool = False) -> tuple[Record, Record]:
    """The records to fit on and to judge by. ``quiet``: without noise; ``empty``: with nothing hidden."""
    hidden = () if empty else made(draw.number).hidden
    first, second = (simulated(draw, hidden, run, 0.0 if quiet else draw.noise).record for run in RUNS)
    return first, second
