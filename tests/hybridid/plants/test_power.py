"""What every plant must keep: its declarations agree, and no port makes energy.

For any efforts at the ports, stored energy changes by what the inputs bring less what the plant's own
dampers take less the sum of effort times velocity: an identity, checked at random states. It fails
for any wrong sign, lever arm or forgotten reaction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from hybridid.plants.duffing import Duffing
from hybridid.plants.emps import EMPS
from hybridid.plants.esea import ESEA
from hybridid.plants.flexible_link import FlexibleLink
from hybridid.plants.half_car import HalfCar
from hybridid.plants.plant import Plant
from hybridid.plants.servo import GRAVITY, Servo

Scalars = SimpleNamespace


@dataclass(frozen=True)
class Ledger:
    """A plant's stored energy and the power that its inputs bring in less what its own dampers take.

    ``tyres`` are ports whose velocity the plant does not know: with the road still, minus the axle's.
    """

    plant: Plant
    energy: Callable[[Scalars, Scalars, Scalars], ca.SX]
    power: Callable[[Scalars, Scalars, Scalars], ca.SX]
    tyres: Callable[[Scalars], dict[str, ca.SX]] = lambda x: {}


def half_car_energy(x, u, p):
    d_f, d_r = x.z_f - x.z_c + p.l_f * x.theta, x.z_r - x.z_c - p.l_r * x.theta
    kinetic = p.m_c * x.z_c_dot**2 + p.I_yy * x.theta_dot**2 + p.m_f * x.z_f_dot**2 + p.m_r * x.z_r_dot**2
    springs = p.k_f * d_f**2 + p.k_r * d_r**2 + p.k_t * ((u.u_f - x.z_f) ** 2 + (u.u_r - x.z_r) ** 2)
    return 0.5 * (kinetic + springs)


def half_car_power(x, u, p):
    front = x.z_f_dot - x.z_c_dot + p.l_f * x.theta_dot
    rear = x.z_r_dot - x.z_c_dot - p.l_r * x.theta_dot
    return -p.c_f * front**2 - p.c_r * rear**2


def motor_power(x, u, p):
    current = (u.voltage - p.K_g * p.k_m * x.theta_dot) / p.R_m
    return p.eta_g * p.eta_m * p.K_g * p.k_t * current * x.theta_dot


def servo_energy(x, u, p):
    height = p.l * (1 - ca.cos(x.q))
    return 0.5 * (p.J + p.m * p.l**2) * x.v**2 + p.m * GRAVITY * height


def servo_power(x, u, p):
    asked = u.kp * 4096 / (2 * ca.pi * 256 * 885) * (u.goal - x.q - p.q_0)
    duty = 0.5 * (ca.sqrt((asked + 1) ** 2 + 1e-6) - ca.sqrt((asked - 1) ** 2 + 1e-6))
    current = u.enabled * (u.supply * duty - p.k_t * x.v) / (p.R - p.R_s * (1 - duty**2))
    return p.k_t * current * x.v


LEDGERS = (
    Ledger(EMPS(), lambda x, u, p: 0.5 * p.M * x.v**2, lambda x, u, p: u.force * x.v),
    Ledger(
        ESEA(),
        lambda x, u, p: (
            0.5 * (p.J * x.delta_dot**2 + p.I * x.theta_dot**2 + p.K_e * (x.delta - x.theta) ** 2)
        ),
        lambda x, u, p: u.torque * x.delta_dot,
    ),
    Ledger(
        HalfCar(),
        half_car_energy,
        half_car_power,
        lambda x: {"front_tyre": -x.z_f_dot, "rear_tyre": -x.z_r_dot},
    ),
    Ledger(
        Duffing(),
        lambda x, u, p: 0.5 * (p.m * x.y_dot**2 + p.k * x.y**2),
        lambda x, u, p: u.V1 * x.y_dot - p.d * x.y_dot**2,
    ),
    Ledger(
        FlexibleLink(),
        lambda x, u, p: (
            0.5 * (p.J_eq * x.theta_dot**2 + p.J_l * (x.theta_dot + x.alpha_dot) ** 2 + p.K_s * x.alpha**2)
        ),
        motor_power,
    ),
    Ledger(Servo(), servo_energy, servo_power),
)
EACH = pytest.mark.parametrize("ledger", LEDGERS, ids=lambda ledger: ledger.plant.name)


def scalars(names: list[str]) -> Scalars:
    return Scalars(**{name: ca.SX.sym(name) for name in names})


@EACH
def test_no_port_makes_energy(ledger):
    plant = ledger.plant
    x = scalars([s.name for s in plant.states])
    u = scalars([s.name for s in plant.inputs])
    p = scalars([q.name for q in plant.parameters])
    effort = {port.name: ca.SX.sym(port.name) for port in plant.ports if port.kind == "effort"}
    state = ca.vertcat(*vars(x).values())
    rates = plant.derivative(x, u, p, effort)
    velocity = {name: at.velocity for name, at in plant.motion(x, u, p).items()} | ledger.tyres(x)
    lost = sum(effort[name] * velocity[name] for name in effort)
    change = ca.jtimes(ledger.energy(x, u, p), state, ca.vertcat(*[rates[name] for name in vars(x)]))
    symbols = [ca.vertcat(*vars(group).values()) for group in (x, u, p)] + [ca.vertcat(*effort.values())]
    gap = ca.Function("gap", symbols, [change - ledger.power(x, u, p) + lost, change])
    random = np.random.default_rng(1)
    for _ in range(20):
        error, size = gap(*[random.normal(size=s.shape[0]) + 2 for s in symbols])
        assert abs(float(error)) < 1e-9 * max(1.0, abs(float(size)))


@EACH
def test_the_declarations_agree(ledger):
    plant = ledger.plant
    x = scalars([s.name for s in plant.states])
    u = scalars([s.name for s in plant.inputs])
    p = scalars([q.name for q in plant.parameters])
    efforts = {port.name: port for port in plant.ports if port.kind == "effort"}
    outputs = {s.name: s.unit for s in plant.outputs}
    assert set(plant.motion(x, u, p)) == set(efforts)
    assert set(plant.derivative(x, u, p, dict.fromkeys(efforts, ca.SX(0)))) == set(vars(x))
    assert set(plant.output(x, u, p)) == set(outputs)
    for state in plant.states:
        assert state.observed_by is None or state.observed_by in outputs
    signals = {s.name: s.unit for s in plant.inputs} | outputs
    for port in plant.ports:
        if port.kind != "effort":
            assert port.effort_unit == signals[port.name]
    for text in (plant.name, plant.meaning, plant.source, *(q.meaning for q in plant.parameters)):
        assert text


@EACH
def test_a_states_declared_output_is_that_output(ledger):
    """``observed_by`` with derivative k: the output's k-th time derivative, up to a constant."""
    plant = ledger.plant
    x = scalars([s.name for s in plant.states])
    u = scalars([s.name for s in plant.inputs])
    p = scalars([q.name for q in plant.parameters])
    efforts = {port.name: ca.SX(0) for port in plant.ports if port.kind == "effort"}
    state = ca.vertcat(*vars(x).values())
    rates = plant.derivative(x, u, p, efforts)
    for declared in plant.states:
        if declared.observed_by is None:
            continue
        shown = plant.output(x, u, p)[declared.observed_by]
        for _ in range(declared.derivative):
            shown = ca.jtimes(shown, state, ca.vertcat(*[rates[name] for name in vars(x)]))
        slope = ca.jacobian(shown - getattr(x, declared.name), state)
        assert ca.simplify(slope).is_zero() or not ca.symvar(ca.simplify(slope))
        assert float(ca.norm_inf(ca.evalf(slope))) == 0
