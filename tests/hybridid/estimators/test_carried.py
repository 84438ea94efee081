"""Inner states run on from horizon to horizon, and so does how they depend on the parameters."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.estimators.carried import by_parameter
from hybridid.estimators.coupled import Coupled
from hybridid.estimators.method import GAUSS_NEWTON
from hybridid.estimators.problem import build_problem
from hybridid.estimators.stop import Stop
from hybridid.simulation import machine_code
from hybridid.simulation.compiler import c_compiler
from hybridid.simulation.shooter import Shooter
from hybridid.simulation.windows import cut

FREE = ("M", "carriage.maxwell.k", "carriage.maxwell.tau")
CARRIED = (2,)
WAYS = [
    pytest.param(
        True,
        marks=pytest.mark.skipif(c_compiler() is None, reason="no C compiler on this machine"),
        id="compiled",
    ),
    pytest.param(False, id="interpreted"),
]


@pytest.fixture(params=WAYS)
def shooter(request, monkeypatch, carriage, make_model):
    """Horizons of 70 samples, which calls of 2500 do not divide; the last of the record is shorter."""
    monkeypatch.setattr(machine_code, "WORTH", 0.0 if request.param else np.inf)
    model = make_model(("viscous", "maxwell"))
    return Shooter(model, cut([carriage.record(180), carriage.record(150)], 70, 2), FREE, "rk4", CARRIED)


def start_of(shooter):
    x0 = np.zeros((shooter.windows.count, 3))
    x0[:, 1] = np.random.default_rng(2).normal(size=len(x0)) * 0.1
    return x0


def values_of(shooter, **changed):
    values = {"carriage.maxwell.k": 300.0, "carriage.maxwell.tau": 0.2}
    return shooter.model.values({**values, **changed})


def test_a_state_goes_on_where_the_horizon_before_has_left_it(shooter):
    windows = shooter.windows
    assert windows.follows == (-1, 0, 1, -1, 3)
    shot = shooter(start_of(shooter), values_of(shooter))
    ends = shot.ends(windows)
    for k, before in enumerate(windows.follows):
        assert shot.states[k, 0, 2] == (0.0 if before < 0 else ends[before, 2])
    assert np.abs(shot.states[[1, 2, 4], 0, 2]).min() > 0
    np.testing.assert_array_equal(shot.states[:, 0, :2], start_of(shooter)[:, :2])


def test_what_follows_nothing_among_the_horizons_begins_as_given(shooter):
    x0 = start_of(shooter)
    x0[:, 2] = 0.01
    some = shooter.over(shooter.windows.select([1, 2, 4]))
    begun = some(x0[[1, 2, 4]], values_of(shooter)).states[:, 0, 2]
    assert begun[0] == 0.01
    assert begun[1] != 0.01
    assert begun[2] == 0.01


def test_the_ends_of_horizons_have_sensitivities_too(shooter):
    """By parameter and by state, against finite differences."""
    x0, p = start_of(shooter), values_of(shooter)
    by = shooter(x0, p, sensitivities=True).ends_by
    names = [q.name for q in shooter.model.parameters]
    for k, name in enumerate(FREE):
        nudge = np.zeros(len(p))
        nudge[names.index(name)] = 1e-4 * p[names.index(name)]
        ends = [shooter(x0, p + sign * nudge).ends(shooter.windows) for sign in (1, -1)]
        slope = (ends[0] - ends[1]) / (2 * nudge.max())
        first = [j for j, before in enumerate(shooter.windows.follows) if before < 0]
        np.testing.assert_allclose(by[first, 3 + k], slope[first], rtol=1e-4, atol=1e-7 * np.abs(slope).max())
    ends = [shooter(x0 + sign * np.array([0.0, 1e-6, 0.0]), p).ends(shooter.windows)[0] for sign in (1, -1)]
    np.testing.assert_allclose(by[0, 1], (ends[0] - ends[1]) / 2e-6, rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize("estimated", [False, True])
def test_parameters_act_through_the_horizons_before(carriage, make_model, estimated):
    """dy/dp of later horizons, against finite differences; estimated initial states follow the parameters."""
    model = make_model(("viscous", "maxwell"))
    problem = build_problem(model, [carriage.record(210)], 70, 2, estimated, FREE)
    names = [q.name for q in model.parameters]
    p = model.values({"carriage.maxwell.k": 300.0, "carriage.maxwell.tau": 0.2})
    begun = problem.measured_x0()

    def exact(*begin):
        return GAUSS_NEWTON.solve(*begin, stop=Stop(tolerance=1e-12))

    def run(q):
        x0 = exact(problem.estimating(()), q, begun).x0 if estimated else begun
        return x0, problem.shooter(x0, q)

    x0, _ = run(p)
    shot = problem.shooter(x0, p, sensitivities=True)
    total = by_parameter(problem, shot)
    for k, name in enumerate(FREE):
        nudge = np.zeros(len(p))
        nudge[names.index(name)] = 1e-3 * p[names.index(name)]
        (above, up), (below, down) = run(p + nudge), run(p - nudge)
        follows = np.einsum("whys,ws->why", shot.by_state[..., :2], (above - below)[:, :2])
        slope = ((up.outputs - down.outputs) - follows) / (2 * nudge.max())
        missed = np.abs(total[1:, ..., k] - slope[1:]).max()
        assert missed < 5e-3 * np.abs(slope[1:]).max()
        assert missed < 0.5 * np.abs(shot.by_parameter[1:, ..., k] - slope[1:]).max(), "their own say less"


def test_the_coupled_gradient_is_the_cost_s(carriage, make_model):
    """By every parameter and every estimated initial state, against finite differences."""
    model = make_model(("viscous", "maxwell"))
    problem = build_problem(model, [carriage.record(210), carriage.record(100)], 40, 2, free=FREE)
    names = [q.name for q in model.parameters]
    p = model.values({"M": 80.0, "carriage.maxwell.k": 300.0, "carriage.maxwell.tau": 0.2})
    x0 = problem.measured_x0()
    ones = np.ones(len(FREE)), np.ones(3)
    found = Coupled.of(problem, problem.shooter(x0, p, sensitivities=True), *ones)
    assert found.finite

    def slope(dp, dx):
        up, down = (problem.cost(problem.shooter(x0 + s * dx, p + s * dp)) for s in (1, -1))
        return (up - down) / 2

    for k, name in enumerate(FREE):
        nudge = np.zeros(len(p))
        nudge[names.index(name)] = size = 1e-5 * p[names.index(name)]
        assert found.gp[k] == pytest.approx(slope(nudge, 0 * x0) / size, rel=1e-4)
    for k in range(len(x0)):
        for j in range(2):
            nudge = np.zeros_like(x0)
            nudge[k, j] = 1e-6
            largest = np.abs(found.gx[:, j]).max()
            assert found.gx[k, j] == pytest.approx(slope(0 * p, nudge) / 1e-6, abs=1e-4 * largest)
    assert np.abs(found.gx[:, 2]).max() == 0.0, "inner states are handed on, not estimated"


def test_a_horizon_that_left_the_numbers_hands_nothing_on(shooter):
    x0 = start_of(shooter)
    x0[0, 1] = np.inf
    x0[:, 2] = 0.02
    assert shooter(x0, values_of(shooter)).states[1, 0, 2] == 0.02
