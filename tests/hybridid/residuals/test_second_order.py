"""``optimiser=lbfgs``: an exact gradient, an optimum that seeds share, and the same way to report as adam."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.residuals.objective import FreeRun, Shape
from hybridid.residuals.orders import Orders
from hybridid.residuals.regressors import Scaling
from hybridid.residuals.samples import samples_of
from hybridid.residuals.settings import Architecture, Training
from hybridid.residuals.stretches import training
from hybridid.residuals.training import Task, train, train_stack

SETTINGS = Training(
    (5, None), optimiser="lbfgs", starts=2, epochs=60, patience=60, weight_decay=0.03, blocks=10
)


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def samples(one, architecture, settings):
    exact = replace(settings, precision="double")
    return samples_of((one,), Scaling.of((one,), 1), architecture, architecture.orders, exact)


@pytest.mark.parametrize("horizon", [7, None])
@pytest.mark.parametrize(
    ("orders", "depth", "increment"),
    [(Orders(2, (2,), 1), 3, False), (Orders(3, (0,), 2), 1, True), (Orders(0, (2,), 1), 2, False)],
)
def test_the_gradient_is_that_of_the_error(series, horizon, orders, depth, increment):
    one = series(120, 0)
    architecture = Architecture(orders, depth, 4, increment=increment)
    made = samples(one, architecture, SETTINGS)
    shape = Shape.of(architecture, 0.7)
    error = FreeRun(shape, made, training(made, shape.lags, horizon), 1e6)
    flat = shape.start(np.random.default_rng(3))
    square, slopes = error.with_gradient(flat)
    assert square == error(flat)
    for k in range(0, shape.count, 3):
        step = 1e-6 * np.eye(shape.count)[k]
        found = (error(flat + step) - error(flat - step)) / 2e-6
        assert slopes[k] == pytest.approx(found, rel=1e-5, abs=1e-8)


def test_its_free_run_is_that_of_the_network(series, small):
    """The objective simulates what the network, read from its weights, simulates."""
    found = train(Task((series(300, 0),), small, seed=1), replace(SETTINGS, starts=1))
    other = series(300, 0)
    error = found.network.free_run(other.seen).error - other.error
    trained = np.concatenate([np.arange(a, b) for a, b in samples(other, small, SETTINGS).split.train])
    assert rms(error[trained]) == pytest.approx(
        found.history[-1].train ** 0.5 * found.network.scaling.error, rel=1e-6
    )
    assert found.stopped[1].startswith("whole record: ")


def test_seeds_end_alike_where_those_of_adam_do_not(series, small):
    one, other = series(500, 0), series(500, 50)
    tasks = [Task((one,), small, seed) for seed in range(4)]
    adam = Training((5,), epochs=60, patience=60, weight_decay=0.03, batch=128, learning_rate=5e-3)
    spreads, means = [], []
    for settings in (SETTINGS, adam):
        found = train_stack(tasks, settings)
        errors = [rms(one.network.free_run(other.seen).error - other.error) for one in found]
        spreads.append(np.std(errors, ddof=1) / np.mean(errors))
        means.append(np.mean(errors))
    assert spreads[0] < 0.15
    assert spreads[0] < spreads[1]
    assert means[0] < means[1]


def test_the_starts_are_members_of_the_network(series, small):
    one = series(300, 0)
    found = train(Task((one,), small), replace(SETTINGS, starts=3))
    assert len(found.network.members) == 3
    mean = rms(found.network.free_run(one.seen).error - one.error)
    alone = [replace(found.network, members=(member,)) for member in found.network.members]
    assert mean <= np.mean([rms(each.free_run(one.seen).error - one.error) for each in alone])
    assert len(train(Task((one,), small), replace(SETTINGS, starts=1)).network.members) == 1


def test_starts_no_better_than_no_network_are_left_out(series, small):
    """With so strong a prior, every start ends at zero; one stays, so that its error can be told."""
    found = train(Task((series(300, 0),), small), replace(SETTINGS, weight_decay=30.0))
    assert len(found.network.members) == 1
    assert found.held_out == pytest.approx(found.zero, rel=0.05)


def test_a_rounding_error_moves_its_error_by_less_than_a_tenth(series, small):
    """Another machine rounds otherwise, and hundreds of steps enlarge that."""
    one = series(300, 0)
    shaken = replace(one, error=one.error * (1 + 1e-12 * np.random.default_rng(0).normal(size=300)))
    first, second = (train(Task((s,), small), SETTINGS) for s in (one, shaken))
    assert second.held_out == pytest.approx(first.held_out, rel=0.1)


def test_the_held_out_error_ends_it_without_a_prior(series, small):
    noisy = series(200, 0, noise=0.3)
    settings = replace(SETTINGS, epochs=300, patience=20, weight_decay=0.0, starts=1)
    found = train(Task((noisy,), small), settings)
    assert found.stopped[-1].startswith("whole record: no gain in 20 epochs")
    last = [epoch.held_out for epoch in found.history if epoch.horizon is None]
    assert found.held_out == pytest.approx(min(last) ** 0.5 * found.network.scaling.error)


def test_windows_may_judge_as_in_the_thesis(series, small):
    settings = replace(SETTINGS, horizons=(1, 5), criterion="horizon", epochs=20)
    found = train(Task((series(300, 0),), small), settings)
    assert found.history[-1].held_out < 0.2
    assert found.history[-1].held_out != pytest.approx((found.held_out / found.network.scaling.error) ** 2)


def test_progress_runs_to_the_end(series, small):
    seen = []
    train_stack([Task((series(300, 0),), small, seed) for seed in (0, 1)], SETTINGS, seen.append)
    fractions = [report.fraction for report in seen]
    assert fractions == sorted(fractions)
    assert 0.9 < fractions[-1] <= 1.0


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"horizons": (None, 5)}, "null may be the last"),
        ({"horizons": (10, None), "optimiser": "adam"}, "only optimiser=lbfgs can"),
        ({"starts": 2, "optimiser": "adam"}, "starts is 2: only optimiser=lbfgs"),
        ({"horizons": (10, None), "criterion": "horizon"}, "needs a last horizon in samples"),
    ],
)
def test_settings_that_cannot_be(settings, words):
    with pytest.raises(ValueError, match=words):
        Training(**{"optimiser": "lbfgs", **settings})
