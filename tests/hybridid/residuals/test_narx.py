"""A network's free run: equal to torch's, bounded, and honest when it diverges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from hybridid.residuals.narx import NARX, Weights, scaled_run
from hybridid.residuals.orders import Orders
from hybridid.residuals.regressors import Scaling, exogenous, scaled_error
from hybridid.residuals.settings import Architecture
from hybridid.residuals.stack import new_stack


@pytest.fixture
def make_network(series):
    """An untrained network with weights of size, and the stack that it came from."""

    def make(architecture, gain=1.0, seed=5):
        stack = new_stack([architecture], [seed], [gain], "double")
        with torch.no_grad():
            stack.layers[-1][0].mul_(3.0)
            for _, bias in stack.layers:
                bias.normal_(generator=torch.Generator().manual_seed(1)).mul_(0.1)
        one = series(400, 0)
        network = NARX(
            output="y",
            unit="m",
            dt=0.01,
            input_names=("u",),
            architecture=architecture,
            scaling=Scaling.of([one], architecture.every),
            members=(stack.weights(0),),
            limit=1e6,
            seed=seed,
            records=("record 0",),
            provenance="simulated",
        )
        return network, stack

    return make


@pytest.mark.parametrize("depth", [1, 3])
@pytest.mark.parametrize(("increment", "gain"), [(False, 1.0), (True, 0.05)])
def test_compiled_and_torch_agree_step_by_step(series, make_network, depth, increment, gain):
    architecture = Architecture(Orders(3, (2,), 2), depth, 6, increment=increment)
    network, stack = make_network(architecture, gain)
    one = series(400, 0)
    rows = exogenous(one.seen, slice(0, 400), architecture.orders, network.scaling, 1)
    with torch.no_grad():
        expected = stack(torch.zeros(1, 1, 3, dtype=torch.float64), torch.from_numpy(rows)[None, None])
    found = network.free_run(one.seen)
    assert found.diverged_at is None
    assert np.ptp(found.error) > 0.1
    np.testing.assert_allclose(found.error / network.scaling.error, expected[0, 0].numpy(), atol=1e-9)


@pytest.mark.parametrize("width", [1, 3, 8, 17, 32])
@pytest.mark.parametrize("lags", [1, 4, 7])
def test_compiled_and_numpy_agree_to_rounding(width, lags):
    """Widths and lags that are no multiple of what the compiled code does at once; neurons of any size."""
    dice = np.random.default_rng([width, lags])
    shapes = [(width, lags + 5), (width, width), (width, width), (1, width)]
    matrices = tuple(dice.normal(size=shape) * 0.8 / shape[1] ** 0.5 for shape in shapes)
    biases = tuple(dice.normal(size=len(matrix)) for matrix in matrices)
    rows, past = dice.normal(size=(300, 5)) * np.geomspace(1e-9, 60, 300)[:, None], dice.normal(size=lags)
    found, stayed = scaled_run([Weights(matrices, biases)], rows, past, 0.0, 1e6)
    expected = []
    for row in rows:
        x = np.concatenate([past, row])
        for matrix, bias in zip(matrices[:-1], biases[:-1], strict=True):
            x = matrix @ x + bias
            x = np.where(x > 0, x, np.expm1(np.minimum(x, 0)))
        expected.append(float((matrices[-1] @ x + biases[-1])[0]))
        past = np.array([expected[-1], *past[:-1]])
    assert stayed == 300
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())


def test_a_network_without_past_errors(series, make_network):
    network, _ = make_network(Architecture(Orders(0, (3,), 0), 2, 4))
    assert np.isfinite(network.free_run(series(100, 1).seen).error).all()


def test_one_step_starts_from_measured_errors(series, make_network):
    architecture = Architecture(Orders(2, (1,), 1), 2, 4)
    network, stack = make_network(architecture)
    one = series(60, 2)
    past = scaled_error(one, slice(0, 60), network.scaling, 1)
    rows = exogenous(one.seen, slice(0, 60), architecture.orders, network.scaling, 1)
    t = 33
    with torch.no_grad():
        lags = torch.tensor(past[[t - 1, t - 2]])[None, None]
        expected = stack(lags, torch.from_numpy(rows[t : t + 1])[None, None])
    assert network.one_step(one)[t] == pytest.approx(float(expected) * network.scaling.error)
    assert np.isnan(network.one_step(one)[:2]).all()


def test_each_piece_begins_without_error(series, make_network):
    network, _ = make_network(Architecture(Orders(2, (1,), 1), 2, 4))
    one = series(80, 0).seen
    cut = replace(one, breaks=(0, 50))
    alone = replace(one, inputs=one.inputs[50:], gray=one.gray[50:])
    np.testing.assert_allclose(network.free_run(cut).error[50:], network.free_run(alone).error)


def test_a_coarse_grid_is_linear_in_between(series, make_network):
    network, _ = make_network(Architecture(Orders(2, (1,), 1), 2, 4, every=5))
    error = network.free_run(series(101, 0).seen).error
    np.testing.assert_allclose(error[12], 0.6 * error[10] + 0.4 * error[15])


def test_of_several_members_the_mean_of_their_own_runs(series, make_network):
    architecture = Architecture(Orders(2, (2,), 1), 2, 4)
    (first, _), (second, _) = make_network(architecture, seed=1), make_network(architecture, seed=2)
    both = replace(first, members=(*first.members, *second.members))
    seen = series(100, 1).seen
    alone = [one.free_run(seen).error for one in (first, second)]
    assert np.ptp(alone[0] - alone[1]) > 0.1
    np.testing.assert_allclose(both.free_run(seen).error, np.mean(alone, axis=0), rtol=1e-12)
    assert both.count == first.count == both.members[1].count
    assert both.silent().count == 0


class TestRunningAway:
    @pytest.fixture
    def runaway(self, make_network):
        """e(t) = 1.5 e(t-1) + 1, from weights alone: it leaves any bound."""
        network, _ = make_network(Architecture(Orders(1, (0,), 0), 1, 1))
        weights = Weights((np.array([[1.5]]), np.array([[1.0]])), (np.array([1.0]), np.array([0.0])))
        scaling = replace(network.scaling, error=1.0)
        return replace(network, members=(weights,), scaling=scaling, limit=100.0)

    def test_is_told_with_its_time_and_not_clipped(self, series, runaway):
        run = runaway.free_run(series(50, 0).seen)
        sequence = [1.0]
        while sequence[-1] <= 100:
            sequence.append(1.5 * sequence[-1] + 1)
        stayed = len(sequence) - 1
        np.testing.assert_allclose(run.error[:stayed], sequence[:stayed])
        assert np.isnan(run.error[stayed:]).all()
        assert run.diverged_at == pytest.approx(stayed * 0.01)
        assert run.status == f"diverged at t = {stayed * 0.01:.4g} s: |error| above 100 m"

    def test_one_member_is_enough(self, series, runaway):
        calm = replace(runaway.members[0], matrices=(np.zeros((1, 1)), np.array([[1.0]])))
        both = replace(runaway, members=(calm, *runaway.members))
        run, alone = (one.free_run(series(50, 0).seen) for one in (both, runaway))
        assert run.diverged_at == alone.diverged_at
        assert np.isnan(run.error[-1])

    def test_what_is_not_a_number_counts_as_running_away(self, series, runaway):
        broken = replace(
            runaway, members=(replace(runaway.members[0], biases=(np.array([np.nan]), np.zeros(1))),)
        )
        assert broken.free_run(series(50, 0).seen).diverged_at == 0.0


def test_another_machine_is_refused(series, make_network):
    network, _ = make_network(Architecture(Orders(1, (1,), 0), 1, 2))
    seen = series(50, 0).seen
    with pytest.raises(ValueError, match="from u; it was given y and torque"):
        network.free_run(replace(seen, input_names=("torque",)))
    with pytest.raises(ValueError, match=r"every 0\.01 s, these come every 0\.02 s"):
        network.free_run(replace(seen, dt=0.02))
