"""The blocks of the normal equations are those of the whole Jacobian, written out row by row."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.declarations import Signal
from hybridid.estimators import coupled
from hybridid.estimators.coupled import Coupled
from hybridid.estimators.normal_equations import Normal
from hybridid.estimators.problem import build_problem
from hybridid.estimators.reduced import LeastSquares
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.records.record import Channel
from hybridid.simulation import machine_code

VALUES = {
    "M": 85.0,
    "carriage.maxwell.k": 300.0,
    "carriage.maxwell.tau": 0.2,
    "carriage.flexible_mode.m_l": 40.0,
}


class SpeedToo(EMPS):
    """The EMPS with a sensor of its velocity."""

    outputs = (*EMPS.outputs, Signal("velocity", "m/s", "carriage velocity"))

    def output(self, x, u, p):
        return {**super().output(x, u, p), "velocity": x.v}


def with_speed(record):
    """``record`` with a second output that is nothing like the first."""
    speed = np.gradient(record.outputs[:, 0], record.dt)[:, None]
    channels = (*record.output_channels, Channel("velocity", "m/s"))
    return replace(record, outputs=np.hstack([record.outputs, speed]), output_channels=channels)


@pytest.fixture
def problem_of(carriage):
    """A problem of two records in horizons of 40 samples, the last of each padded, away from its solution."""

    def make(*effects, outputs=1, estimate_x0=True, lengths=(190, 110)):
        records = [carriage.record(n) for n in lengths]
        if outputs == 2:
            records = [with_speed(record) for record in records]
        model = compose(SpeedToo() if outputs == 2 else EMPS(), effects)
        problem = build_problem(model, records, 40, 2, estimate_x0)
        assert not problem.windows.used.all(), "no horizon is padded"
        assert max(problem.windows.follows) >= 0
        return problem

    return make


def shot_of(problem):
    names = {q.name for q in problem.model.parameters}
    p = problem.model.values({name: value for name, value in VALUES.items() if name in names})
    x0 = problem.measured_x0() + 1e-3 * np.arange(problem.windows.count)[:, None]
    return problem.shooter(x0, p, sensitivities=True)


def written_out(problem, shot, forgotten=0.0):
    """J'J and J'r by the parameters and all initial states (n + w m), one row of J after another.

    How the state in which a horizon begins depends on all of them follows from how that before ended. What a
    horizon feels of an earlier initial state counts if it is above ``forgotten`` times its own.
    """
    variables = LeastSquares.of(problem)
    w, m, n = problem.windows.count, len(variables.x), len(variables.p)
    size = np.concatenate([variables.p, np.tile(variables.x, w)])
    gram, error = np.zeros((len(size), len(size))), np.zeros(len(size))
    begins = np.zeros((w, m, len(size)))
    places = [n + m * k + np.arange(m) for k in range(w)]
    residuals = problem.residuals(shot)
    for k, before in enumerate(problem.windows.follows):
        if before >= 0 and problem.carried.any():
            end = shot.ends_by[before][:m].T @ begins[before]
            end[:, :n] += shot.ends_by[before][m:].T
            begins[k, problem.carried] = end[problem.carried]
        used, own = problem.windows.used[k], np.where(problem.moving[k], np.eye(m), 0.0)
        by_state = shot.by_state[k][used] / problem.scale[:, None]
        least = forgotten * np.linalg.norm(by_state @ own, axis=(0, 1))
        for j in range(k):
            if not (np.linalg.norm(by_state @ begins[k][:, places[j]], axis=(0, 1)) > least).any():
                begins[k][:, places[j]] = 0.0
        begins[k][:, places[k]] = own
        rows = by_state @ begins[k]
        rows[..., :n] += shot.by_parameter[k][used] / problem.scale[:, None]
        for row, r in zip(rows.reshape(-1, len(size)) * size, residuals[k][used].ravel(), strict=True):
            gram += np.outer(row, row)
            error += row * r
    return gram, error


def close(found, expected):
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("outputs", [1, 2])
@pytest.mark.parametrize("estimate_x0", [True, False])
def test_horizons_on_their_own(problem_of, outputs, estimate_x0):
    problem = problem_of("viscous", "coulomb", outputs=outputs, estimate_x0=estimate_x0)
    shot = shot_of(problem)
    found = LeastSquares.of(problem).linearised(shot)
    assert isinstance(found, Normal)
    gram, error = written_out(problem, shot)
    n, (w, m) = len(problem.free), problem.moving.shape
    close(found.pp, gram[:n, :n])
    close(found.gp, -error[:n])
    close(found.gx, -error[n:].reshape(w, m))
    close(found.xp, gram[n:, :n].reshape(w, m, n))
    close(found.xx, gram[n:, n:].reshape(w, m, w, m)[np.arange(w), :, np.arange(w)])
    assert estimate_x0 == bool(found.xx.any())


def assembled(found):
    """The matrix of coupled equations, by the parameters and all initial states (n + w m, n + w m)."""
    n, (w, m) = len(found.gp), found.estimated.shape
    own = np.flatnonzero(found.estimated[0])
    gram = np.zeros((n + w * m, n + w * m))
    gram[:n, :n] = found.chains.pp
    for chain, xx, xp in zip(found.members, found.chains.xx, found.chains.xp, strict=True):
        there = np.repeat(chain >= 0, len(own))
        rows = (n + chain[chain >= 0, None] * m + own).ravel()
        gram[np.ix_(rows, rows)] = xx[np.ix_(there, there)]
        gram[rows, :n], gram[:n, rows] = xp[there], xp[there].T
        assert not xx[~there].any()
        assert not xp[~there].any()
    return gram


@pytest.mark.parametrize("forgotten", [0.0, 0.01])
@pytest.mark.parametrize("outputs", [1, 2])
@pytest.mark.parametrize("effect", ["maxwell", "flexible_mode"])
def test_horizons_that_hand_states_on(monkeypatch, problem_of, effect, outputs, forgotten):
    """One inner state and two; the second record begins in the middle."""
    monkeypatch.setattr(coupled, "FORGOTTEN", forgotten)
    problem = problem_of("viscous", effect, outputs=outputs)
    shot = shot_of(problem)
    found = LeastSquares.of(problem).linearised(shot)
    assert isinstance(found, Coupled)
    gram, error = written_out(problem, shot, forgotten)
    close(assembled(found), gram)
    close(np.concatenate([found.gp, found.gx.ravel()]), -error)
    n, m = len(problem.free), len(problem.model.states)
    assert gram[n : n + m, n + m : n + 2 * m].any(), "the second horizon feels where the first began"


@pytest.mark.parametrize("damping", [1e-10, 1e-2])
@pytest.mark.parametrize("held", [(), (0,)])
def test_a_step_by_chains_is_that_of_the_whole_matrix(problem_of, damping, held):
    """Two records of unequal length: the second chain is shorter."""
    problem = problem_of("viscous", "flexible_mode")
    found = LeastSquares.of(problem).linearised(shot_of(problem))
    assert len(found.members) == 2
    assert (found.members < 0).any()
    n, (w, m) = len(found.gp), found.estimated.shape
    gram, gradient = assembled(found), np.concatenate([found.gp, found.gx.ravel()])
    moving = np.diag(gram) > 0
    moving[list(held)] = False
    expected, size = np.zeros(n + w * m), np.sqrt(np.diag(gram)[moving])
    scaled = gram[np.ix_(moving, moving)] / np.outer(size, size) + damping * np.eye(moving.sum())
    expected[moving] = -np.linalg.solve(scaled, gradient[moving] / size) / size
    fixed = np.isin(np.arange(n), held)
    for dp, dx in (found.step(damping, fixed), _by_all_at_once(found, damping, fixed)):
        np.testing.assert_allclose(dp, expected[:n], rtol=1e-6, atol=1e-9 * np.abs(expected[:n]).max())
        np.testing.assert_allclose(dx.ravel(), expected[n:], rtol=1e-6, atol=1e-8 * np.abs(dx).max())
        promised = -(gradient @ expected + expected @ gram @ expected / 2)
        assert found.predicted(dp, dx) == pytest.approx(promised, rel=1e-6)


def _by_all_at_once(found, damping, fixed):
    """The step where a matrix is not positive definite by rounding."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(coupled, "_by_cholesky", lambda *given: None)
        return found.step(damping, fixed)


@pytest.mark.parametrize("effects", [("coulomb",), ("maxwell",), ("flexible_mode",)])
def test_products_made_in_c_give_the_same_equations(monkeypatch, problem_of, effects):
    monkeypatch.setattr(machine_code, "WORTH", 0.0)
    problem = problem_of("viscous", *effects, outputs=2)
    p, x0 = problem.model.values(), problem.measured_x0()
    fast, whole = problem.shot(x0, p, sensitivities=True), problem.shooter(x0, p, sensitivities=True)
    assert fast.multiplied == problem.shooter.code.worth_it
    assert problem.cost(fast) == pytest.approx(problem.cost(whole), rel=1e-12)
    ours, theirs = (LeastSquares.of(problem).linearised(shot) for shot in (fast, whole))
    ours, theirs = (one.chains if isinstance(one, Coupled) else one for one in (ours, theirs))
    for name in ("pp", "xp", "xx", "gp", "gx"):
        a, b = getattr(ours, name), getattr(theirs, name)
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-11 * np.abs(b).max())


def test_what_is_hardly_felt_is_left_out(monkeypatch, problem_of):
    problem = problem_of("viscous", "maxwell")
    shot = shot_of(problem)
    n, m = len(problem.free), len(problem.model.states)
    between = {}
    for forgotten in (0.0, 1e9):
        monkeypatch.setattr(coupled, "FORGOTTEN", forgotten)
        found = assembled(LeastSquares.of(problem).linearised(shot))
        between[forgotten] = np.abs(found[n : n + m, n + m :]).max()
    assert between[0.0] > 0.0
    assert between[1e9] == 0.0


@pytest.mark.parametrize("effect", ["coulomb", "maxwell"])
def test_initial_states_alone(problem_of, effect):
    problem = problem_of("viscous", effect).estimating(())
    shot = shot_of(problem)
    gram, error = written_out(problem, shot)
    found = LeastSquares.of(problem).linearised(shot)
    w, m = problem.moving.shape
    close(found.gx, -error.reshape(w, m))
    assert found.gp.shape == (0,)
    if isinstance(found, Normal):
        close(found.xx, gram.reshape(w, m, w, m)[np.arange(w), :, np.arange(w)])
    else:
        close(assembled(found), gram)


@pytest.mark.parametrize("effects", [("viscous", "coulomb"), ("viscous", "maxwell")])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_only_a_sample_in_use_can_spoil_them(problem_of, effects, bad):
    problem = problem_of(*effects)
    variables, shot = LeastSquares.of(problem), shot_of(problem)
    clean = variables.linearised(shot)
    k = int(np.flatnonzero(~problem.windows.used.all(axis=1))[0])
    sample = int(problem.windows.used[k].sum())

    def spoilt(at):
        names = ("by_state", "by_parameter", "outputs")
        changed = replace(shot, **{name: np.array(getattr(shot, name)) for name in names})
        for name in names:
            getattr(changed, name)[k, at] = bad
        return variables.linearised(changed)

    assert not spoilt(sample - 1).finite
    padded = spoilt(sample)
    assert padded.finite
    np.testing.assert_array_equal(padded.gp, clean.gp)
    np.testing.assert_array_equal(padded.gx, clean.gx)
