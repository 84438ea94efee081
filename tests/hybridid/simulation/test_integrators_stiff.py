"""Stiff models: an L-stable method, its small linear systems, and pre-sliding friction on the eSEA.

The reference is SciPy's LSODA on equations written here, not the package's own.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import odeint
from scipy.signal import chirp

from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.plants.esea import ESEA
from hybridid.records.record import Channel, Record
from hybridid.simulation import Diverged, simulate
from hybridid.simulation.elimination import Elimination
from hybridid.simulation.integrators import INTEGRATORS
from hybridid.simulation.stability import first_substeps, substeps_for, substeps_wanted

DT = 0.002
INERTIA, ROTOR, SPRING = 0.0014, 0.0001, 8.459


@dataclass(frozen=True)
class Bristles:
    """LuGre friction at the motor: ``F = f_v v + f_c (z + tau_b z')``; Dahl's with the rest at zero."""

    s: float
    f_c: float = 0.03
    tau_b: float = 0.0
    r_s: float = 0.0
    v_s: float = 0.5
    f_v: float = 0.0

    def __call__(self, v: float, z: float) -> tuple[float, float]:
        rate = (v - abs(v) * z / (1 + self.r_s * np.exp(-((v / self.v_s) ** 2)))) / self.s
        return self.f_v * v + self.f_c * (z + self.tau_b * rate), rate

    @property
    def effects(self) -> list[str]:
        return ["viscous@motor", "lugre@motor"] if self.r_s else ["dahl@motor"]

    @property
    def values(self) -> dict[str, float]:
        if not self.r_s:
            return {"motor.dahl.f_c": self.f_c, "motor.dahl.s": self.s}
        shape = {f"motor.lugre.{k}": getattr(self, k) for k in ("f_c", "s", "tau_b", "r_s", "v_s")}
        return {**shape, "motor.viscous.f_v": self.f_v}


def run(friction: Bristles, duration: float = 1.5) -> Record:
    """The joint under a swept sine of torque, integrated to 1e-9."""
    time = np.arange(round(duration / DT) + 1) * DT
    torque = 0.12 * chirp(time, 1.0, time[-1], 5.0, phi=-90)

    def rate(t, x):
        motor, link, delta, theta, z = x
        effort, bristle = friction(motor, z)
        twist = SPRING * (delta - theta)
        return [(np.interp(t, time, torque) - twist - effort) / ROTOR, twist / INERTIA, motor, link, bristle]

    states = odeint(rate, np.zeros(5), time, tfirst=True, rtol=1e-9, atol=1e-11, hmax=DT)
    return Record(
        "eSEA",
        time,
        torque[:, None],
        states[:, 1:2],
        (Channel("torque", "N·m", "foh"),),
        (Channel("link_velocity", "rad/s"),),
        simulated=True,
    )


SOFT = Bristles(s=0.02)
STIFF = Bristles(s=3e-4)
STIFF_LUGRE = Bristles(s=1e-3, tau_b=0.002, r_s=0.4, f_v=0.002)


@pytest.fixture(scope="module", params=[SOFT, STIFF, STIFF_LUGRE], ids=["dahl", "stiff dahl", "stiff lugre"])
def esea(request):
    return request.param, run(request.param)


def error(friction: Bristles, record: Record, substeps: int | None, integrator: str) -> float:
    """RMS error over the RMS of the link velocity; infinite if it diverges."""
    model = compose(ESEA(), friction.effects)
    start = np.zeros(len(model.states))
    try:
        made = simulate(model, friction.values, record, start, substeps, integrator)
    except Diverged:
        return np.inf
    return float(np.sqrt(np.mean((made.outputs - record.outputs) ** 2)) / record.outputs.std())


def test_the_implicit_method_meets_the_reference_with_its_own_steps(esea):
    friction, record = esea
    assert error(friction, record, None, "rodas3") < 1e-3


def test_more_implicit_steps_come_nearer(esea):
    friction, record = esea
    errors = [error(friction, record, n, "rodas3") for n in (1, 4, 16)]
    assert errors[0] < 0.05, "one step a sample is stable, whatever the stiffness"
    assert errors[1] < 0.2 * errors[0]
    assert errors[2] < 1e-5


def test_sub_stepped_rk4_suffices_for_soft_bristles():
    record = run(SOFT)
    model = compose(ESEA(), SOFT.effects)
    assert 1 < substeps_for(model, model.values(SOFT.values), [record]) <= 10
    assert error(SOFT, record, None, "rk4") < 1e-4


def test_rk4_fails_on_stiff_bristles_and_says_what_helps():
    record = run(STIFF)
    model = compose(ESEA(), STIFF.effects)
    assert error(STIFF, record, 2, "rk4") == np.inf
    with pytest.raises(ValueError, match=r"too stiff for RK4.*estimator.integrator to rodas3"):
        substeps_for(model, model.values(STIFF.values), [record])
    assert substeps_for(model, model.values(STIFF.values), [record], integrator="rodas3") <= 8


@pytest.mark.parametrize("stiffness", [1e4, 1e8, 1e12])
def test_a_stiff_mode_is_gone_after_a_step_or_two(stiffness):
    """L-stability: M v' = -f_v v with f_v h / M far above what any explicit method bears."""
    model = compose(EMPS(), ["viscous"])
    p = model.values({"M": 1.0, "carriage.viscous.f_v": stiffness})
    step = INTEGRATORS["rodas3"](model, 0.01, True)
    x = np.array([0.0, 1.0])
    for _ in range(2):
        x = np.asarray(step(0.0, x, [0.0], p)).ravel()
    assert abs(x[1]) < 1e-3
    assert x[0] == pytest.approx(1 / stiffness, rel=0.2, abs=1e-9)


def test_sticking_friction_asks_the_implicit_method_for_steps_too():
    """The slope of sign(v) jumps near rest: its derivatives need steps that a linear damper does not."""
    record = run(SOFT)
    damped = compose(ESEA(), ["viscous@motor"])
    dry = compose(ESEA(), ["coulomb@motor"], {"motor.epsilon": {"fixed": 0.02}})
    strong = damped.values({"motor.viscous.f_v": 2.0})
    assert first_substeps(damped, strong, [record], "rodas3") == 1
    assert substeps_wanted(damped, strong, [record]) > 20, "RK4 would need them"
    assert first_substeps(dry, dry.values({"motor.coulomb.f_c": 0.03}), [record], "rodas3") > 4


@pytest.mark.parametrize("n", [1, 4, 9])
def test_elimination_solves_small_sparse_systems(n):
    random = np.random.default_rng(n)
    dense = np.where(random.random((n, n)) < 0.4, random.normal(size=(n, n)), 0.0)
    np.fill_diagonal(dense, 3.0 + random.random(n))
    symbols = ca.SX.sym("a", ca.sparsify(ca.DM(dense)).sparsity())
    right = ca.SX.sym("b", n, 2)
    system = Elimination.of(symbols)
    solution = ca.horzcat(system.solve(right[:, 0]), system.solve(right[:, 1]))
    b = random.normal(size=(n, 2))
    solve = ca.Function("solve", [symbols, right], [solution])
    np.testing.assert_allclose(np.asarray(solve(dense, b)), np.linalg.solve(dense, b), rtol=1e-10)
    numbers = ca.SX.sym("n", system.numbers.shape[0])
    again = ca.Function("again", [numbers, right], [system.with_numbers(numbers).solve(right[:, 0])])
    known = ca.Function("known", [symbols], [system.numbers])(dense)
    np.testing.assert_allclose(np.asarray(again(known, b)), np.asarray(solve(dense, b))[:, :1], rtol=1e-12)
