"""Folds cut the records, and the choice keeps to its rule."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.estimators import FitSettings
from hybridid.residuals.held_out import Candidate, FoldScore, Scored, choose, compare, folds
from hybridid.residuals.rbf import RBFNetwork
from hybridid.residuals.rbf_fit import RBFPlan
from hybridid.simulation.simulate import simulate


def scored(nodes, errors, horizon=None):
    """A candidate whose folds left these mean square errors, of an output of spread one."""
    found = tuple(
        FoldScore(np.array([1.0]), np.array([e]), "" if np.isfinite(e) else "it diverged") for e in errors
    )
    return Scored(Candidate(RBFPlan(nodes), FitSettings(horizon=horizon)), found, np.array([1.0]))


class TestFolds:
    def test_each_sample_is_held_out_once_and_never_fitted_there(self, carriage):
        record = carriage.record()
        seen = np.zeros(record.n)
        for fold in folds([record], 4):
            held = {t for part in fold.held_out for t in part.time}
            assert not held & {t for part in fold.fitted for t in part.time}
            assert len(held) + sum(part.n for part in fold.fitted) == record.n
            seen += np.isin(record.time, list(held))
        np.testing.assert_array_equal(seen, 1)

    @pytest.mark.parametrize(("count", "words"), [(1, "at least 2"), (20, "has only 600 samples")])
    def test_refusals(self, carriage, count, words):
        with pytest.raises(ValueError, match=words):
            folds([carriage.record()], count)


class TestChoice:
    def test_the_smallest_within_one_standard_error(self):
        tried = [
            scored(4, [1.1, 0.9, 1.0, 1.2]),
            scored(8, [1.2, 0.8, 0.9, 1.1]),
            scored(32, [1.1, 0.9, 0.9, 1.1]),
        ]
        assert choose(tried).candidate.plan.nodes == 4

    def test_a_clear_gain_is_taken(self):
        tried = [scored(4, [1.1, 0.9, 1.0, 1.2]), scored(8, [0.3, 0.2, 0.25, 0.3])]
        assert choose(tried).candidate.plan.nodes == 8

    def test_among_equal_sizes_the_lowest(self):
        tried = [scored(4, [1.0, 1.2], 100), scored(4, [1.0, 1.1], 500)]
        assert choose(tried).candidate.settings.horizon == 500

    def test_one_that_failed_on_a_fold_is_out(self):
        assert choose([scored(4, [0.1, np.inf]), scored(8, [1.0, 1.0])]).candidate.plan.nodes == 8

    def test_all_failed(self):
        with pytest.raises(ValueError, match="every one failed \\(it diverged\\)"):
            choose([scored(4, [np.inf, np.inf])])

    def test_scores_are_of_mean_squares(self):
        one = scored(4, [1.0, 9.0])
        assert one.rmse == pytest.approx(5**0.5)
        assert one.score == pytest.approx(5.0)
        assert one.standard_error == pytest.approx(4.0)


def test_compare_sees_a_law_that_the_gray_box_lacks(make_model, carriage):
    """A carriage with a bump in its friction, simulated: held-out, the network beats the gray box."""
    gray, record = make_model(), carriage.record()
    network = RBFNetwork(1, (0.05, 0.15)).effect(gray.plant.port("carriage"))
    truth = {**carriage.truth, "carriage.rbf.c_1": 0.1, "carriage.rbf.s_1": 0.03, "carriage.rbf.w_1": 9.0}
    run = simulate(gray.plus(network, "carriage"), truth, record)
    bumpy = type(record)(
        "bumpy",
        record.time,
        record.inputs,
        run.outputs,
        record.input_channels,
        record.output_channels,
        simulated=True,
    )
    settings = FitSettings(horizon=200, max_iterations=15)
    candidates = [Candidate(RBFPlan(nodes), settings) for nodes in (1, 6)]
    small, right = compare(gray, [bumpy], candidates, settings, count=2)
    assert right.rmse < 0.7 * right.gray_rmse
    assert right.score < small.score
    assert choose([small, right]) is right
