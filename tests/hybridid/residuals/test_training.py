"""Training: learns, stops, repeats itself, and does in a stack what it does alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from hybridid.residuals.choice import chosen_network
from hybridid.residuals.orders import Orders
from hybridid.residuals.settings import Architecture, Training
from hybridid.residuals.training import Task, train, train_stack


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def weights_of(found):
    return np.concatenate([a.ravel() for one in found.network.members for a in (*one.matrices, *one.biases)])


class TestLearning:
    def test_the_free_run_on_an_unseen_record_beats_no_correction(self, series, trained):
        other = series(1500, 99)
        run = trained.network.free_run(other.seen)
        assert run.status == "bounded"
        assert rms(run.error - other.error) < 0.25 * rms(other.error)

    def test_it_says_what_it_reached_on_the_held_out_blocks(self, trained):
        assert trained.held_out < 0.25 * trained.zero
        best = min(epoch.held_out for epoch in trained.history)
        assert trained.held_out == pytest.approx(best**0.5 * trained.network.scaling.error)

    def test_of_noise_it_says_that_nothing_was_learned(self, series, small, trained):
        one = series(1500, 0)
        white = replace(one, error=np.random.default_rng(1234).normal(size=1500))
        found = train(Task((white,), small), Training(horizons=(1, 10), epochs=15, patience=4))
        assert 0.9 < found.held_out / found.zero < 1.05
        assert chosen_network([found]) is None
        assert chosen_network([trained]) is trained

    @pytest.mark.parametrize("optimiser", ["adam", "lbfgs"])
    def test_what_was_not_measured_moves_nothing(self, series, small, trained, brief, optimiser):
        """A tenth of the error is missing in stretches: the others still teach the network."""
        settings = replace(brief, optimiser=optimiser)
        one, other = series(2000, 0), series(1500, 99)
        missing = np.arange(2000) % 400 >= 360
        found = train(Task((replace(one, error=np.where(missing, np.nan, one.error)),), small, 3), settings)
        assert np.isfinite(weights_of(found)).all()
        assert found.zero == pytest.approx(trained.zero, rel=0.3)
        run = found.network.free_run(other.seen)
        assert rms(run.error - other.error) < 0.35 * rms(other.error)

    def test_longer_horizons_are_trained_after_shorter_ones(self, trained):
        horizons = [epoch.horizon for epoch in trained.history]
        assert sorted(horizons) == horizons
        assert set(horizons) == {1, 20}

    def test_the_multi_step_loss_lowers_the_free_run_error(self, series, small):
        """A network too small for the law does better in free run when trained in free run."""
        tiny = replace(small, depth=1, width=2, orders=Orders(1, (1,), 0))
        one, other = series(2500, 0), series(2500, 50)
        common = {"epochs": 60, "patience": 10, "batch": 256, "learning_rate": 1e-2}
        seeds = [Task((one,), tiny, seed) for seed in range(4)]
        errors = [
            np.median(
                [rms(f.network.free_run(other.seen).error - other.error) for f in train_stack(seeds, s)]
            )
            for s in (Training((1,), **common), Training((1, 10, 40), **common))
        ]
        assert errors[1] < 0.9 * errors[0]


class TestStopping:
    def test_it_stops_when_nothing_improves(self, series, small):
        settings = Training(horizons=(1,), epochs=500, patience=3, batch=128, learning_rate=0.01)
        found = train(Task((series(800, 0),), small), settings)
        assert 5 < len(found.history) < 500
        assert min(e.held_out for e in found.history) < 0.5
        assert found.stopped == (f"horizon 1: no gain in 3 epochs, {len(found.history)} epochs",)
        assert min(e.held_out for e in found.history[-3:]) > min(e.held_out for e in found.history)

    def test_it_keeps_the_best_and_not_the_last(self, series, small):
        settings = Training(horizons=(1,), epochs=30, patience=30, learning_rate=0.3)
        found = train(Task((series(400, 0),), small), settings)
        assert found.stopped == ("horizon 1: all epochs used, 30 epochs",)
        assert (
            found.held_out**2
            <= min(e.held_out for e in found.history) * found.network.scaling.error**2 * 1.001
        )

    def test_blocks_too_short_for_the_horizon_are_refused(self, series, small):
        with pytest.raises(ValueError, match=r"reaches 50 samples .* a held-out block of y has 30"):
            train(Task((series(300, 0),), small), Training(horizons=(50,), criterion="horizon"))
        with pytest.raises(ValueError, match=r"reaches 200 samples .* a training block of y has 120"):
            train(Task((series(300, 0),), small), Training(horizons=(200,)))

    def test_a_free_run_is_judged_on_blocks_shorter_than_the_horizon(self, series, small):
        """Held-out blocks of 30 samples lie within one free run; only windows would have to fit into them."""
        found = train(Task((series(300, 0),), small), Training(horizons=(50,), epochs=2, patience=2))
        assert len(found.history) == 2
        assert np.isfinite(found.held_out)


class TestStacks:
    @pytest.fixture
    def settings(self):
        return Training(horizons=(1, 5), epochs=8, patience=2, batch=128, precision="double")

    def test_equal_networks_trained_alone(self, series, small, settings):
        one = series(600, 0)
        seeds = (0, 1, 2)
        together = train_stack([Task((one,), small, seed) for seed in seeds], settings)
        for seed, found in zip(seeds, together, strict=True):
            alone = train(Task((one,), small, seed), settings)
            assert found.stopped == alone.stopped
            np.testing.assert_allclose(weights_of(found), weights_of(alone), atol=1e-9)

    def test_hold_networks_of_other_orders_and_outputs(self, series, settings):
        first, second = series(600, 0), series(600, 7)
        second = replace(second, seen=replace(second.seen, output="z"))
        tasks = [
            Task((first,), Architecture(Orders(4, (1,), 0), 2, 6)),
            Task((second,), Architecture(Orders(1, (3,), 2), 2, 6)),
        ]
        for task, found in zip(tasks, train_stack(tasks, settings), strict=True):
            assert found.network.members[0].matrices[0].shape == (6, task.architecture.orders.regressors)
            assert found.network.output == task.series[0].seen.output
            np.testing.assert_allclose(weights_of(found), weights_of(train(task, settings)), atol=1e-9)

    @pytest.mark.parametrize("weight_decay", [0.0, 1e-2])
    def test_hold_networks_of_other_depths_and_widths(self, series, small, settings, weight_decay):
        settings = replace(settings, weight_decay=weight_decay)
        one = series(600, 0)
        sizes = [(1, 4), (3, 6), (2, 9)]
        tasks = [Task((one,), replace(small, depth=d, width=w), seed=k) for k, (d, w) in enumerate(sizes)]
        for task, found in zip(tasks, train_stack(tasks, settings), strict=True):
            alone = train(task, settings)
            assert [m.shape for m in found.network.members[0].matrices] == [
                m.shape for m in alone.network.members[0].matrices
            ]
            np.testing.assert_allclose(weights_of(found), weights_of(alone), atol=1e-9)
            assert found.held_out == pytest.approx(alone.held_out, rel=1e-9)

    def test_of_which_one_gives_increments_are_refused(self, series, small, settings):
        tasks = [Task((series(600, 0),), small), Task((series(600, 0),), replace(small, increment=True))]
        with pytest.raises(ValueError, match=r"share residual\.increment"):
            train_stack(tasks, settings)

    def test_of_other_lengths_are_refused(self, series, small, settings):
        with pytest.raises(ValueError, match="same length"):
            train_stack([Task((series(600, 0),), small), Task((series(500, 0),), small)], settings)


class TestRepeating:
    settings = Training(horizons=(1, 5), epochs=4, batch=128)

    def test_a_seed_gives_the_same_network(self, series, small):
        task = Task((series(500, 0),), small, seed=11)
        np.testing.assert_array_equal(
            weights_of(train(task, self.settings)), weights_of(train(task, self.settings))
        )

    def test_another_seed_gives_another(self, series, small):
        first, second = (train(Task((series(500, 0),), small, seed), self.settings) for seed in (1, 2))
        assert np.abs(weights_of(first) - weights_of(second)).max() > 0.01

    def test_torch_s_own_dice_and_threads_stay_as_they_were(self, series, small):
        torch.manual_seed(4)
        expected, threads = torch.rand(3), torch.get_num_threads()
        torch.manual_seed(4)
        train(Task((series(500, 0),), small), self.settings)
        assert torch.equal(torch.rand(3), expected)
        assert torch.get_num_threads() == threads


def test_progress_runs_to_the_end(series, small):
    seen = []
    train(Task((series(500, 0),), small), Training(horizons=(1, 5), epochs=3), seen.append)
    fractions = [report.fraction for report in seen]
    assert fractions == sorted(fractions)
    assert fractions[-1] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"horizons": (10, 1)}, "rising numbers"),
        ({"horizons": ()}, "give at least one"),
        ({"held_out": 0.9}, "at most 0.5"),
        ({"epochs": 0}, "epochs is 0: at least 1"),
        ({"learning_rate": 0.0}, "must be positive"),
        ({"guard": 1.0}, "above 1"),
        ({"weight_decay": -1.0}, "at least 0"),
    ],
)
def test_settings_that_cannot_be(settings, words):
    with pytest.raises(ValueError, match=words):
        Training(**settings)


@pytest.mark.parametrize(
    ("given", "words"), [({"depth": 0}, "depth is 0"), ({"increment": True}, "at least 1")]
)
def test_architectures_that_cannot_be(given, words):
    with pytest.raises(ValueError, match=words):
        Architecture(Orders(0, (1,), 1), **given)
