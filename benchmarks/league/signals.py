"""What a practitioner makes of a record: derivatives, and the equation of motion as a regression.

    y = B theta + sum of columns of effects

Outputs and inputs pass the same zero-phase Butterworth filter; derivatives are those of a spline through
the filtered outputs; what a nonlinear law gives along that motion is filtered once as well ("parallel
filtering", Janot, Gautier, Brunot 2019). A held input acts half a sample late. Samples near rest are
dropped. Where only part of a machine is measured, the rest is derived from the machine's own equations:

* eSEA, link velocity alone: the link's angle is its integral, the motor's angle follows from the link's
  equation, delta = theta + I theta''/K_e; both equations added are the regression.
* half-car, heave and pitch rate alone: strut forces follow from the chassis' equations, the axles from the
  road less what these forces press into the tyres, in four rounds, since k_f ... I_yy are found on the way.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import make_interp_spline
from scipy.signal import butter, sosfiltfilt

from benchmarks.league.machines import VOLTS_TO_TORQUE
from hybridid.plants.esea import ESEA
from hybridid.plants.half_car import HalfCar
from hybridid.records.record import Record

Array = NDArray[np.float64]
ORDER = 4
EDGE = 0.1  # s, dropped at both ends
REST = 0.01  # of the largest speed: slower samples are dropped, with those
SMEARED = 0.8  # periods of the cutoff about them
ROUNDS = 4  # of the half-car's axles
Motion = tuple[Array, Array, Array]
KNOWN = {p.name: p.guess for plant in (ESEA(), HalfCar()) for p in plant.parameters if p.fixed}


@dataclass(frozen=True)
class Equation:
    """The regression of one record, its equations one below the other: ``y`` (N,), ``base`` (N, k).

    ``motion``: port -> position, velocity, acceleration (n,) each; ``push(port, F)`` what an effort F (n,)
    at a port does to the right-hand side (N,); ``inputs`` port -> signal (n,); ``output`` the port where a
    sensor's effects can be tried; ``smooth`` the filter; ``keep`` the samples that count, equation by
    equation; ``scaled`` says that inertias are known, so that a gain can show.
    """

    time: Array
    y: Array
    base: Array
    motion: Mapping[str, Motion]
    push: Callable[[str, Array], Array]
    inputs: Mapping[str, Array]
    output: str | None
    smooth: Callable[[Array], Array]
    keep: Array
    cutoff: float
    scaled: bool = False

    @property
    def dt(self) -> float:
        return float(self.time[1] - self.time[0])

    def rate(self, x: Array) -> Array:
        """Time derivative of a column, equation by equation."""
        return np.concatenate([_slope(part, self.dt) for part in x.reshape(-1, len(self.time))])


def equation(machine: str, record: Record, cutoff: float) -> Equation:
    """The regression of ``record`` with its signals filtered at ``cutoff`` [Hz]."""
    make = {"esea": _esea, "half_car": _half_car, "flexible_link": _flexible_link}.get(machine, _one_mass)
    return make(machine, record, _filter(record, cutoff), cutoff)


def _filter(record: Record, cutoff: float) -> Callable[[Array], Array]:
    sos = butter(ORDER, min(cutoff, 0.4 / record.dt), fs=1 / record.dt, output="sos")
    return lambda x: sosfiltfilt(sos, x)


def _late(u: Array) -> Array:
    """A held input as it acts on average about each sample: half a sample late, by a cubic spline."""
    n = np.arange(len(u), dtype=float)
    return make_interp_spline(n, u, 3)(n - 0.5)


def _derivatives(x: Array, dt: float, count: int) -> list[Array]:
    made = [x]
    for _ in range(count):
        made.append(_slope(made[-1], dt))
    return made


def _slope(x: Array, dt: float) -> Array:
    """Derivative (n,) of a quintic spline through ``x``: true to 0.6 % to a quarter of the sampling rate."""
    n = np.arange(len(x), dtype=float)
    return make_interp_spline(n, x, 5).derivative()(n) / dt


def _keep(time: Array, cutoff: float, *speeds: Array) -> Array:
    """Which samples count: off both ends, and off rest by as long as the filter smears a jump of sign(v)."""
    inner = (time > time[0] + EDGE) & (time < time[-1] - EDGE)
    reach = round(SMEARED / cutoff / (time[1] - time[0]))
    for v in speeds:
        slow = np.abs(v) < REST * np.abs(v).max()
        slow[1:] |= v[1:] * v[:-1] <= 0
        inner &= np.convolve(slow, np.ones(2 * reach + 1), "same") < 0.5
    return inner


def _one_mass(machine: str, record: Record, smooth: Callable[[Array], Array], cutoff: float) -> Equation:
    port, output = ("oscillator", "V2") if machine == "oscillator" else ("carriage", "position")
    u = _late(record.inputs[:, 0])
    q, v, a = _derivatives(smooth(record.outputs[:, 0]), record.dt, 2)
    one = np.ones_like(q)
    sign = smooth(np.sign(v))
    columns = {
        "oscillator": (a, v, q, one),
        "carriage_level": (a, v, sign),
    }.get(machine, (a, v, sign, one))
    return Equation(
        time=record.time,
        y=smooth(u),
        base=np.column_stack(columns),
        motion={port: (q, v, a)},
        push=lambda _, effort: smooth(effort),
        inputs={record.input_channels[0].name: u},
        output=output,
        smooth=smooth,
        cutoff=cutoff,
        keep=_keep(record.time, cutoff, *(() if machine == "oscillator" else (v,))),
    )


def _flexible_link(machine: str, record: Record, smooth: Callable[[Array], Array], cutoff: float) -> Equation:
    """Both equations added, and the link's: two rows a sample."""
    volts = _late(record.inputs[:, 0])
    theta, theta_1, theta_2 = _derivatives(smooth(record.outputs[:, 0]), record.dt, 2)
    alpha, alpha_1, alpha_2 = _derivatives(smooth(record.outputs[:, 1]), record.dt, 2)
    drive = VOLTS_TO_TORQUE * (smooth(volts) - 70.0 * 7.68e-3 * theta_1)
    zero = np.zeros_like(theta)
    tip_2 = theta_2 + alpha_2
    columns = [(theta_2, zero), (tip_2, tip_2), (theta_1, zero), (zero, alpha), (zero, alpha_1)]
    where = {"servo": (1.0, 0.0), "link": (0.0, 1.0)}
    return Equation(
        time=record.time,
        y=np.concatenate([drive, zero]),
        base=np.column_stack([np.concatenate(pair) for pair in columns]),
        motion={"servo": (theta, theta_1, theta_2), "link": (alpha, alpha_1, alpha_2)},
        push=lambda port, effort: np.concatenate([w * smooth(effort) for w in where[port]]),
        inputs={"voltage": volts},
        output=None,
        smooth=smooth,
        cutoff=cutoff,
        keep=np.tile(_keep(record.time, cutoff, theta_1), 2),
    )


def _esea(machine: str, record: Record, smooth: Callable[[Array], Array], cutoff: float) -> Equation:
    inertia, motor, spring, dt = KNOWN["I"], KNOWN["J"], KNOWN["K_e"], record.dt
    torque = _late(record.inputs[:, 0])
    rates = _derivatives(smooth(record.outputs[:, 0]), dt, 4)  # theta' to theta'''''
    theta = cumulative_trapezoid(rates[0], dx=dt, initial=0.0)
    delta = theta + inertia * rates[1] / spring
    delta_1, delta_2 = rates[0] + inertia * rates[2] / spring, rates[1] + inertia * rates[3] / spring

    known = motor * delta_2 + inertia * rates[1]

    def push(port: str, effort: Array) -> Array:
        """An effort at the link or the joint also shifts the motor that is derived from the link."""
        made = smooth(effort)
        shifted = motor / spring * _slope(_slope(made, dt), dt)
        return {"motor": made, "link": made + shifted, "elastomer": -shifted}[port]

    return Equation(
        time=record.time,
        y=smooth(torque) - known,
        base=delta_1[:, None],
        motion={
            "motor": (delta, delta_1, delta_2),
            "link": (theta, rates[0], rates[1]),
            "elastomer": (delta - theta, delta_1 - rates[0], delta_2 - rates[1]),
        },
        push=push,
        inputs={"torque": torque},
        output="link_velocity",
        smooth=smooth,
        cutoff=cutoff,
        keep=_keep(record.time, cutoff, delta_1),
        scaled=True,
    )


def _half_car(machine: str, record: Record, smooth: Callable[[Array], Array], cutoff: float) -> Equation:
    """Heave m_c z'' = F_f + F_r and pitch 0 = -I_yy theta'' + l_r F_r - l_f F_f, two rows a sample."""
    k, dt = KNOWN, record.dt
    road = [smooth(column) for column in record.inputs.T]
    rates = [_derivatives(smooth(y), dt, 1) for y in record.outputs.T]
    z_c, theta = (cumulative_trapezoid(rate[0], dx=dt, initial=0.0) for rate in rates)
    heave, pitch = rates[0][1], rates[1][1]
    corners = {
        "front": (z_c - k["l_f"] * theta, rates[0][0] - k["l_f"] * rates[1][0], k["m_f"], -k["l_f"]),
        "rear": (z_c + k["l_r"] * theta, rates[0][0] + k["l_r"] * rates[1][0], k["m_r"], k["l_r"]),
    }
    inertia, tyre, axles = 2000.0, 5e5, list(road)  # the declared guesses; a rigid tyre to begin with
    y = np.concatenate([k["m_c"] * heave, np.zeros_like(heave)])
    for _ in range(ROUNDS):
        motion = {}
        for axle, (name, (top, top_1, _, _)) in zip(axles, corners.items(), strict=True):
            d, axle_1 = axle - top, _slope(axle, dt)
            motion[f"{name}_suspension"] = (d, axle_1 - top_1, _slope(axle_1 - top_1, dt))
        columns = [
            np.concatenate([x, lever * x])
            for port, lever in (("front_suspension", -k["l_f"]), ("rear_suspension", k["l_r"]))
            for x in motion[port][:2]
        ]
        base = np.column_stack([*columns, np.concatenate([np.zeros_like(pitch), -pitch])])
        found = np.linalg.lstsq(base, y, rcond=None)[0]
        inertia = min(max(float(found[4]), 500.0), 1e4)
        forces = (
            (k["l_r"] * k["m_c"] * heave - inertia * pitch) / (k["l_f"] + k["l_r"]),
            (k["l_f"] * k["m_c"] * heave + inertia * pitch) / (k["l_f"] + k["l_r"]),
        )
        axles = [
            u - (force + mass * _slope(_slope(u, dt), dt)) / tyre
            for u, force, (_, _, mass, _) in zip(road, forces, corners.values(), strict=True)
        ]
    for name, u, axle in zip(corners, road, axles, strict=True):
        motion[f"{name}_tyre"] = (u - axle, np.zeros_like(u), np.zeros_like(u))

    def push(port: str, effort: Array) -> Array:
        """An effort at a tyre lifts the axle that is derived from the road, and so bears on the strut."""
        name, _, where = port.partition("_")
        row = 0 if name == "front" else 2
        force = smooth(effort)
        if where == "tyre":
            force = (found[row] * force + found[row + 1] * _slope(force, dt)) / tyre
        return np.concatenate([force, corners[name][3] * force])

    return Equation(
        time=record.time,
        y=y,
        base=base,
        motion=motion,
        push=push,
        inputs=dict(zip(("u_f", "u_r"), record.inputs.T, strict=True)),
        output=None,
        smooth=smooth,
        cutoff=cutoff,
        keep=np.tile(_keep(record.time, cutoff), 2),
    )
