"""What keeps a complete model off the measured output: the sensor's noise and the simulation's error."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.noise_floor.accuracy import Accuracy, parameter_error, simulation_error
from hybridid.trace.refits.refit import refit, refit_if_possible
from hybridid.trace.rules import Rules
from hybridid.trace.trials import robustness
from hybridid.trace.verdict import _parameters_are_vague, conclude

SEEDS = 16
LOUD = 1e-4  # m, as in larger_than_fitted


def test_the_worst_output_counts():
    noise, parameters, simulation = np.array([3.0, 2.0]), np.array([0.0, 0.0]), np.array([4.0, 0.0])
    assert Accuracy(noise, parameters, simulation).times(np.array([5.0, 30.0])) == pytest.approx(15.0)


def test_the_noise_in_the_parameters_errs_more_in_a_larger_motion(make_model, larger_than_fitted):
    """Fitted with a noise anew each time: the error on a larger motion without noise is as predicted."""
    told, found = [], []
    for seed in range(SEEDS):
        split = larger_than_fitted(seed)
        base = refit(make_model(("viscous",)), split)
        told.append(parameter_error(base, np.array([LOUD]), Context(split)).item())
        found.append(base.score.rmse.item())
    assert np.sqrt(np.mean(np.square(found))) == pytest.approx(np.mean(told), rel=0.3)
    assert np.mean(told) > LOUD


@pytest.mark.parametrize(("wider", "finer_is_too_stiff"), [(1.0, False), (4.0, False), (4.0, True)])
def test_the_simulation_is_to_blame_for_what_too_wide_a_smoothing_leaves(
    make_model, split_of, monkeypatch, wider, finer_is_too_stiff
):
    """The truth creeps as tanh(v/epsilon) does: smoothed four times as wide, a complete model errs by it. If
    half of epsilon is too stiff, twice of it tells as much."""
    split = split_of()
    base = refit(make_model(), split)
    if wider > 1:
        base = refit(base.model, split, [base.values], base, replace(base.numerics, smoothing=wider))
    if finer_is_too_stiff:

        def possible(*given):
            return None if given[-1].smoothing < wider else refit_if_possible(*given)

        monkeypatch.setattr(robustness, "refit_if_possible", possible)
    error = simulation_error(base, Context(split)).item()
    if wider > 1:
        assert error == pytest.approx(base.score.rmse.item(), rel=0.3)
    else:
        assert error < 0.1 * base.score.rmse.item()


def test_an_error_far_above_the_noise_is_never_called_nothing(make_model, split_of):
    """A friction that differs by direction, and a library of one effect that does not resemble it."""
    found = conclude(
        make_model(),
        Context(split_of(df_v=80.0), (effect_named("sensor_lag"),), laws=False, variables=("velocity",)),
    )
    assert found.times > 3
    assert found.verdict == "unexplained"


def test_parameters_that_the_noise_may_have_moved_far_make_no_error_small():
    """68 mrad beside a noise of 20 and parameters that may err by 330."""
    known = Accuracy(np.array([0.020]), np.array([0.330]), np.zeros(1))
    left = np.array([0.068])
    assert known.times(left) < 1.0
    assert known.times_the_least(left) == pytest.approx(3.4)

    def vague(error, stopped=""):
        score = SimpleNamespace(rmse=np.array([error]))
        found = SimpleNamespace(final=SimpleNamespace(score=score), at_noise=bool(stopped))
        return _parameters_are_vague(SimpleNamespace(found=found, accuracy=known), Rules())

    assert vague(0.068)
    assert not vague(0.059), "within three times the noise"
    assert not vague(0.068, stopped="at the noise, fitted to all horizons together")
