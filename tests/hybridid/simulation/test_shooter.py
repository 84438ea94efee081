"""Many horizons at once: the same as one by one, with exact sensitivities."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.model import Model
from hybridid.simulation import simulate
from hybridid.simulation.shooter import Shooter
from hybridid.simulation.windows import cut

FREE = ("carriage.coulomb.f_c", "M", "carriage.dahl.s")


@pytest.fixture(scope="module")
def with_state(make_model) -> Model:
    """Four states of three kinds: position, velocity and a bristle, and a lag on the encoder."""
    return make_model(("viscous", "coulomb", "offset", "dahl", "sensor_lag"))


def start(model: Model, count: int) -> np.ndarray:
    generator = np.random.default_rng(3)
    scale = np.array([s.scale for s in model.states])
    return generator.normal(size=(count, len(model.states))) * 0.1 * scale


@pytest.mark.parametrize("integrator", ["rk4", "rodas3"])
@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_sensitivities_are_the_derivatives_of_the_simulation(with_state, carriage, integrator, hold):
    made = carriage.record(120)
    made = replace(made, input_channels=(replace(made.input_channels[0], hold=hold),))
    shooter = Shooter(with_state, cut([made], 45, 6), FREE, integrator)
    x0, p = start(with_state, shooter.windows.count), with_state.values()
    shot = shooter(x0, p, sensitivities=True)
    np.testing.assert_allclose(shot.outputs, shooter(x0, p).outputs, rtol=1e-12, atol=1e-15)
    for j, state in enumerate(with_state.states):
        step = 1e-6 * state.scale
        moved = np.eye(len(with_state.states))[j] * step
        slope = (shooter(x0 + moved, p).outputs - shooter(x0 - moved, p).outputs) / (2 * step)
        np.testing.assert_allclose(
            shot.by_state[..., j], slope, rtol=1e-5, atol=1e-6 * np.abs(slope).max() + 1e-12
        )
    names = [q.name for q in with_state.parameters]
    for j, name in enumerate(FREE):
        q = with_state.parameters[names.index(name)]
        moved = np.zeros(len(p))
        moved[names.index(name)] = 1e-5 * q.scale
        slope = (shooter(x0, p + moved).outputs - shooter(x0, p - moved).outputs) / (2e-5 * q.scale)
        assert np.abs(slope).max() > 0, name
        np.testing.assert_allclose(
            shot.by_parameter[..., j], slope, rtol=1e-4, atol=1e-5 * np.abs(slope).max(), err_msg=name
        )


def test_horizons_together_are_horizons_alone(with_state, carriage):
    made = carriage.record(200)
    windows = cut([made], 60, 6)
    x0, p = start(with_state, windows.count), with_state.values()
    together = Shooter(with_state, windows)(x0, p)
    for k, (_, begin, end) in enumerate(windows.origin):
        alone = simulate(with_state, {}, made.part(begin, end), x0[k], 6)
        np.testing.assert_allclose(together.outputs[k, : end - begin], alone.outputs, rtol=1e-12, atol=1e-15)
        np.testing.assert_allclose(together.states[k, : end - begin], alone.states, rtol=1e-12, atol=1e-15)


def test_chunks_leave_no_seam(carriage, make_model):
    model, made = make_model(), carriage.record(600)
    whole = cut([made], None, 2)
    pieces = replace(whole, chunk=100)
    shots = [
        Shooter(model, windows, ("M",))(np.zeros((1, 2)), model.values(carriage.truth), sensitivities=True)
        for windows in (replace(whole, chunk=600), pieces)
    ]
    np.testing.assert_allclose(shots[0].outputs, shots[1].outputs, rtol=1e-13, atol=1e-16)
    np.testing.assert_allclose(shots[0].by_parameter, shots[1].by_parameter, rtol=1e-12, atol=1e-16)


def test_a_simulation_that_leaves_the_numbers_is_not_finite(carriage, make_model):
    model = make_model(("cubic_stiffness",))
    shooter = Shooter(model, cut([carriage.record(100)], None, 1))
    shot = shooter(np.array([[1.0, 0.0]]), model.values({"carriage.cubic_stiffness.k_3": -1e9}))
    assert not shot.finite
    assert shooter(np.zeros((1, 2)), model.values({"carriage.cubic_stiffness.k_3": 0.0})).finite
