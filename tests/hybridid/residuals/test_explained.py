"""How much of a network is physics that the model has already."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.estimators.problem import build_problem
from hybridid.model import compose
from hybridid.residuals.explained import effort_explained, explained_share, output_explained
from hybridid.residuals.rbf import RBFNetwork
from hybridid.residuals.settings import RBFBounds
from hybridid.validation import free_run


class TestShare:
    columns = np.linalg.qr(np.random.default_rng(0).normal(size=(500, 4)))[0] * [1.0, 5.0, 1e-3, 1e4]

    def share(self, r):
        return explained_share(r, self.columns[:, :3], ["a", "b", "c"])

    def test_of_the_model_s_own_sensitivities_is_one(self):
        share, alone, changes = self.share(self.columns[:, 1] + 3000 * self.columns[:, 2])
        assert share == pytest.approx(1.0)
        np.testing.assert_allclose(alone, [0.0, 25 / 34, 9 / 34], atol=1e-9)
        np.testing.assert_allclose(changes, [0.0, 1.0, 3000.0], atol=1e-6)

    def test_of_what_is_orthogonal_to_them_is_zero(self):
        assert self.share(self.columns[:, 3])[0] == pytest.approx(0.0, abs=1e-12)

    def test_of_half_and_half(self):
        share, _, _ = self.share(self.columns[:, 0] + 1e-4 * self.columns[:, 3])
        assert share == pytest.approx(0.5)

    def test_twins_count_once(self):
        twins = np.stack([self.columns[:, 0]] * 2, axis=1)
        share, alone, changes = explained_share(2 * self.columns[:, 0], twins, ["a", "b"])
        assert share == pytest.approx(1.0)
        np.testing.assert_allclose(alone, 1.0)
        np.testing.assert_allclose(changes, 1.0)

    def test_of_nothing_is_nothing(self):
        assert self.share(np.zeros(500))[0] == 0.0

    def test_a_parameter_without_effect_explains_nothing(self):
        share, alone, _ = explained_share(np.ones(5), np.zeros((5, 1)), ["a"])
        assert (share, alone[0]) == (0.0, 0.0)


@pytest.fixture(scope="module")
def run(make_model, carriage):
    record = carriage.record()
    model = make_model()
    return model, record, free_run(model, carriage.truth, record)


class TestOutput:
    def test_a_correction_that_more_damping_would_make(self, run, carriage):
        model, record, prediction = run
        problem = build_problem(model, [record], None, 1)
        shot = problem.shooter(prediction.initial_states, model.values(carriage.truth), sensitivities=True)
        column = [p.name for p in model.free].index("carriage.viscous.f_v")
        correction = 7.0 * shot.by_parameter[0, : record.n, :, column]
        found = output_explained(model, carriage.truth, record, prediction, correction)
        assert found.share == pytest.approx(1.0)
        assert found.changes["carriage.viscous.f_v"] == pytest.approx(7.0)
        assert "could have explained 100% of the network's output" in found.warning
        assert found.provenance == "simulated"

    def test_a_correction_faster_than_any_of_them(self, run, carriage):
        model, record, prediction = run
        ripple = np.sin(2 * np.pi * 37 * record.time)[:, None]
        found = output_explained(model, carriage.truth, record, prediction, ripple)
        assert found.share < 0.02
        assert found.warning is None


class TestEffort:
    names = ("M", "carriage.viscous.f_v", "carriage.coulomb.f_c", "carriage.offset.offset")

    def share(self, make_model, carriage, weights, span=(-0.2, 0.2), names=names, **held):
        network = RBFNetwork(len(weights), span, bounds=RBFBounds(width=(0.01, 3.0), weight=(-50.0, 50.0)))
        gray = make_model()
        model = gray.plus(network.effect(gray.plant.port("carriage")), "carriage")
        own = {f"carriage.rbf.w_{k}": w for k, w in enumerate(weights, 1)}
        values = {**carriage.truth, **own, **held}
        record = carriage.record()
        prediction = free_run(model, values, record, "measured")
        return effort_explained(model, "carriage.rbf", names, values, record, prediction)

    def test_a_network_that_is_an_offset(self, make_model, carriage):
        found = self.share(make_model, carriage, [5.0], **{"carriage.rbf.s_1": 3.0})
        assert found.share > 0.99
        assert found.alone["carriage.offset.offset"] > 0.99
        assert found.changes["carriage.offset.offset"] == pytest.approx(5.0, rel=0.05)
        assert "carriage.offset.offset alone" in found.warning

    def test_a_network_that_is_damping(self, make_model, carriage):
        wide = {"carriage.rbf.s_1": 1.0, "carriage.rbf.s_2": 1.0}
        found = self.share(make_model, carriage, [-30.0, 30.0], (-1.0, 1.0), **wide)
        assert found.share > 0.99
        assert found.alone["carriage.viscous.f_v"] > 0.95

    def test_a_network_that_ripples(self, make_model, carriage):
        found = self.share(make_model, carriage, [4.0, -4.0] * 10, (-0.3, 0.3))
        assert found.share < 0.2
        assert found.warning is None

    def test_only_the_named_parameters_may_explain(self, make_model, carriage):
        found = self.share(make_model, carriage, [5.0], names=("M",), **{"carriage.rbf.s_1": 3.0})
        assert set(found.alone) == {"M"}
        assert found.share < 0.2

    def test_a_network_at_a_level_that_is_a_linear_leak(self, tank, leaking):
        """By the rate of the level: a level has no acceleration."""
        gray = compose(tank, ["linear_leak"])
        network = RBFNetwork(1, (0.0, 2.0), "position", RBFBounds(width=(0.1, 3.0)))
        model = gray.plus(network.effect(tank.port("tank")), "tank")
        values = {"tank.linear_leak.k": 1e-3, "tank.rbf.c_1": 2.0, "tank.rbf.s_1": 1.2, "tank.rbf.w_1": 2e-4}
        record = leaking().record(200)
        prediction = free_run(model, values, record, "measured")
        found = effort_explained(model, "tank.rbf", ["tank.linear_leak.k"], values, record, prediction)
        assert found.share > 0.9
        assert found.changes["tank.linear_leak.k"] > 0
