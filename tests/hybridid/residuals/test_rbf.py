"""The RBF network as an effect: its formula, its nesting, its bounds, and its fit in simulation."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from hybridid.declarations import Port
from hybridid.estimators import FitSettings
from hybridid.model import compose
from hybridid.residuals.rbf import RBFNetwork
from hybridid.residuals.rbf_fit import RBFPlan, fit_rbf, visited
from hybridid.residuals.settings import RBFBounds
from hybridid.simulation.simulate import simulate
from hybridid.validation import free_run

THESIS = RBFBounds(centre=(-1.0, 1.0), width=(0.01, 1.0), weight=(-100.0, 100.0))
PORT = Port("carriage", "effort", "N", 30.0, "m", 0.1, 0.1)


def numbers(values, letter, nodes):
    return np.array([values[f"carriage.rbf.{letter}_{k}"] for k in range(1, nodes + 1)])


def gaussians(v, values, nodes):
    c, s, w = (numbers(values, letter, nodes) for letter in "csw")
    return (w * np.exp(-((v[:, None] - c) ** 2) / (2 * s**2))).sum(axis=1)


@pytest.fixture(scope="module")
def bumpy(make_model, carriage):
    model = make_model().plus(RBFNetwork(1, (0.05, 0.15), bounds=THESIS).effect(PORT), "carriage")
    bump = {"carriage.rbf.c_1": 0.1, "carriage.rbf.s_1": 0.04, "carriage.rbf.w_1": 8.0}
    record = carriage.record()
    run = simulate(model, {**carriage.truth, **bump}, record)
    return replace(record, outputs=run.outputs)


@pytest.fixture(scope="module")
def settings():
    return FitSettings(horizon=200, max_iterations=40)


@pytest.fixture(scope="module")
def found(make_model, carriage, bumpy, settings):
    return fit_rbf(make_model(), carriage.truth, [bumpy], RBFPlan(8, physics="fixed"), settings)


@pytest.fixture
def gray(make_model):
    return make_model()


class TestEffect:
    def test_is_the_formula(self, gray, carriage):
        network = RBFNetwork(3, (-0.1, 0.1), bounds=THESIS)
        model = gray.plus(network.effect(PORT), "carriage")
        rng = np.random.default_rng(0)
        own = {f"carriage.rbf.{p.name}": rng.uniform(0.05, 0.3) for p in model.terms[-1].effect.parameters}
        p = model.values({**carriage.truth, **own})
        v = np.linspace(-0.2, 0.2, 9)
        efforts = [float(model.efforts(0, [0.0, speed], [0.0], p)[-1]) for speed in v]
        np.testing.assert_allclose(efforts, gaussians(v, own, 3), rtol=1e-12)

    def test_over_position_it_sees_no_velocity(self, gray):
        model = gray.plus(RBFNetwork(2, (0.0, 0.2), "position").effect(PORT), "carriage")
        p = model.values({"carriage.rbf.w_1": 5.0, "carriage.rbf.w_2": -2.0})
        at = lambda q, v: float(model.efforts(0, [q, v], [0.0], p)[-1])  # noqa: E731
        assert at(0.0, 0.1) == at(0.0, -0.3) == pytest.approx(5.0 - 2.0 * np.exp(-2.0))
        assert model.parameters[-2].unit == "N"
        assert next(q.unit for q in model.parameters if q.name == "carriage.rbf.c_1") == "m"

    def test_at_a_level_it_is_a_flow_over_the_level(self, tank, leaking):
        record = leaking(c=0.0, steady=2e-4).record(60)
        settings = FitSettings(start="guess", max_iterations=5)
        found = fit_rbf(compose(tank), {}, [record], RBFPlan(2), settings)
        assert found.model.terms[-1].effect.title == "radial basis functions of the level, 2 nodes"
        assert (found.network.over, found.model.terms[-1].effect.kind) == ("position", "flow")
        low, high = found.network.span
        assert low < record.outputs.min() < record.outputs.max() < high
        flow = float(found.model.efforts(0, [0.35], [0.0], found.model.values(found.estimate.values)))
        assert flow == pytest.approx(2e-4, rel=0.1)

    def test_without_weights_it_is_not_there(self, gray, carriage):
        model = gray.plus(RBFNetwork(5, (-0.2, 0.2)).effect(PORT), "carriage")
        record = carriage.record(200)
        with_it, without = (simulate(m, carriage.truth, record).outputs for m in (model, gray))
        np.testing.assert_array_equal(with_it, without)

    def test_nodes_start_spread_and_stay_in_their_cells(self):
        effect = RBFNetwork(5, (-0.2, 0.2)).effect(PORT)
        at = {p.name: p.at(PORT) for p in effect.parameters}
        np.testing.assert_allclose(
            [at[f"c_{k}"].guess for k in range(1, 6)], [-0.2, -0.1, 0.0, 0.1, 0.2], atol=1e-12
        )
        assert at["c_2"].upper == pytest.approx(at["c_3"].lower)
        assert (at["s_2"].lower, at["s_2"].guess, at["s_2"].upper) == pytest.approx((0.05, 0.1, 0.15))
        assert (at["w_2"].lower, at["w_2"].guess, at["w_2"].upper) == pytest.approx((-9.999, 0.0, 9.999))

    def test_the_thesis_bounds(self):
        at = {p.name: p.at(PORT) for p in RBFNetwork(4, (-0.13, 0.13), bounds=THESIS).effect(PORT).parameters}
        assert (at["c_1"].lower, at["c_1"].upper) == (-1.0, 1.0)
        assert (at["s_1"].lower, at["s_1"].upper) == (0.01, 1.0)
        assert (at["w_1"].lower, at["w_1"].upper) == pytest.approx((-100.0, 100.0))

    def test_one_node_stands_in_the_middle(self):
        at = {p.name: p.at(PORT) for p in RBFNetwork(1, (0.0, 0.4)).effect(PORT).parameters}
        assert (at["c_1"].guess, at["s_1"].guess) == pytest.approx((0.2, 0.2))

    def test_travels_to_other_processes(self, gray):
        model = gray.plus(RBFNetwork(2, (-0.1, 0.1)).effect(PORT), "carriage")
        again = pickle.loads(pickle.dumps(model))
        assert [p.name for p in again.parameters] == [p.name for p in model.parameters]
        assert again.terms[-1].effect.law == model.terms[-1].effect.law

    @pytest.mark.parametrize(
        ("make", "words"),
        [
            (lambda: RBFNetwork(0, (0.0, 1.0)), "nodes is 0"),
            (lambda: RBFNetwork(4, (1.0, 1.0)), "span"),
            (lambda: RBFNetwork(4, (0.0, 1.0), "speed"), "'speed', allowed: velocity, position"),
            (lambda: RBFBounds(width=(0.0, 1.0)), "width is .*positive"),
            (lambda: RBFBounds(weight=(1.0, -1.0)), "lower bound comes first"),
            (lambda: RBFBounds(centre_room=-1.0), "centre_room"),
            (lambda: RBFPlan(4, physics="frozen"), "'frozen', allowed: refitted, fixed"),
        ],
    )
    def test_refusals(self, make, words):
        with pytest.raises(ValueError, match=words):
            make()


class TestFit:
    def test_fixed_physics_stays(self, found, carriage):
        assert {name: found.estimate.known[name] for name in carriage.truth} == carriage.truth
        assert {p.name.split(".")[1] for p in found.estimate.parameters} == {"rbf"}

    def test_finds_the_bump(self, found, gray, carriage, bumpy):
        v = carriage.states()[:, 1]
        v = np.linspace(np.quantile(v, 0.1), np.quantile(v, 0.9), 40)
        truth = 8.0 * np.exp(-((v - 0.1) ** 2) / (2 * 0.04**2))
        network = gaussians(v, found.estimate.values, 8)
        assert np.sqrt(np.mean((network - truth) ** 2)) < 0.1 * np.sqrt(np.mean(truth**2))
        before = free_run(gray, carriage.truth, bumpy).error
        after = free_run(found.model, found.estimate.values, bumpy).error
        assert after.std() < 0.05 * before.std()

    def test_refitted_physics_does_better_from_a_bent_gray_box(self, make_model, carriage, bumpy, settings):
        bent = {**carriage.truth, "M": 105.0, "carriage.viscous.f_v": 230.0}
        plans = (RBFPlan(4, physics=physics) for physics in ("fixed", "refitted"))
        fixed, refitted = (fit_rbf(make_model(), bent, [bumpy], plan, settings) for plan in plans)
        assert refitted.estimate.cost < 0.2 * fixed.estimate.cost
        assert refitted.estimate.values["M"] == pytest.approx(95.0, rel=0.03)

    def test_nodes_span_what_the_record_visits(self, found, gray, carriage, bumpy, settings):
        low, high = visited(gray, carriage.truth, [bumpy], "carriage", "velocity", settings)
        seen = free_run(gray, carriage.truth, bumpy).states[:, 1]
        assert low < seen.min() < 0 < seen.max() < high
        assert high - low == pytest.approx(1.1 * np.ptp(seen))
        assert found.network.span == (low, high)

    def test_a_port_that_is_not_there(self, gray, carriage, bumpy, settings):
        with pytest.raises(ValueError, match="'carrige': did you mean 'carriage'"):
            fit_rbf(gray, carriage.truth, [bumpy], RBFPlan(4, port="carrige"), settings)
