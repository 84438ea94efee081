"""Orders of convergence against SciPy, with the input held and running between its samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hybridid.model import Model, compose
from hybridid.plants.emps import EMPS
from hybridid.records.record import Channel, Record
from hybridid.simulation import Diverged, simulate

VALUES = {
    "M": 2.0,
    "carriage.viscous.f_v": 3.0,
    "carriage.quadratic_drag.c_d": 40.0,
    "carriage.cubic_stiffness.k_3": 500.0,
}
EPSILON = 0.5


@pytest.fixture(scope="module")
def smooth() -> Model:
    effects = ["viscous", "quadratic_drag", "cubic_stiffness"]
    fixed = {"carriage.epsilon": {"fixed": EPSILON}, "carriage.cubic_stiffness.q_0": {"fixed": 0.1}}
    return compose(EMPS(), effects, fixed)


def record(hold: str, n: int = 41, dt: float = 0.05) -> Record:
    time = np.arange(n) * dt
    return Record(
        name="smooth",
        time=time,
        inputs=(12 * np.sin(2.1 * time) + 4)[:, None],
        outputs=np.linspace(0, 1, n)[:, None],
        input_channels=(Channel("force", "N", hold),),
        output_channels=(Channel("position", "m"),),
    )


def reference(made: Record) -> np.ndarray:
    """The same carriage by DOP853, restarted at every sample, (n, 2)."""
    held = made.input_channels[0].hold == "zoh"
    states = np.tile([0.3, -0.2], (made.n, 1))

    def rate(t, x, before, after):
        u = before if held else before + (after - before) * t / made.dt
        drag = 40.0 * x[1] ** 2 * np.tanh(x[1] / EPSILON)
        return [x[1], (u - 3.0 * x[1] - drag - 500.0 * (x[0] - 0.1) ** 3) / 2.0]

    for k in range(made.n - 1):
        inputs = tuple(made.inputs[k : k + 2, 0])
        solved = solve_ivp(rate, (0, made.dt), states[k], "DOP853", args=inputs, rtol=1e-12, atol=1e-13)
        states[k + 1] = solved.y[:, -1]
    return states


@pytest.mark.parametrize(("integrator", "order"), [("rk4", 4), ("rodas3", 3)])
@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_halving_the_step_lowers_the_error_by_the_order(smooth, hold, integrator, order):
    made = record(hold)
    exact = reference(made)
    errors = []
    for substeps in (2, 4, 8):
        run = simulate(smooth, VALUES, made, np.array([0.3, -0.2]), substeps, integrator)
        errors.append(np.abs(run.states - exact).max())
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 2e-5
    np.testing.assert_allclose(rates, order, atol=0.35)


def test_a_trajectory_starts_where_it_is_told_and_keeps_the_records_time(smooth):
    made = record("zoh")
    run = simulate(smooth, VALUES, made, np.array([0.3, -0.2]), 8)
    np.testing.assert_array_equal(run.time, made.time)
    np.testing.assert_array_equal(run.states[0], [0.3, -0.2])
    np.testing.assert_array_equal(run.outputs[:, 0], run.states[:, 0])
    assert run.state_names == ("q", "v")


def test_without_an_initial_state_it_starts_where_the_record_does(carriage, make_model):
    made = carriage.record()
    run = simulate(make_model(), carriage.truth, made)
    np.testing.assert_allclose(run.states[0], [0.0, 0.0], atol=2e-3)
    assert np.sqrt(np.mean((run.outputs - made.outputs) ** 2)) < 0.05 * made.outputs.std()


def test_a_simulation_that_leaves_the_numbers_says_when(smooth):
    unstable = VALUES | {"carriage.cubic_stiffness.k_3": -5e7}
    with pytest.raises(Diverged, match=r"record smooth diverged at t = [\d.]+ s") as caught:
        simulate(smooth, unstable, record("zoh"), np.array([0.3, -0.2]), 2)
    assert isinstance(caught.value, ValueError)
    assert "\n" not in str(caught.value)


def test_a_record_of_something_else_is_refused_in_one_line(smooth):
    other = replace(record("zoh"), input_channels=(Channel("torque", "N·m"),))
    with pytest.raises(
        ValueError, match="record smooth has the inputs torque, plant emps needs force"
    ) as caught:
        simulate(smooth, VALUES, other)
    assert "\n" not in str(caught.value)
