"""What keeps a complete model off the measured output: the sensor's noise and the simulation's error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.accuracy import Accuracy, parameter_error, simulation_error
from hybridid.trace.context import Context
from hybridid.trace.refit import refit
from hybridid.trace.split import by_record
from hybridid.trace.verdict import conclude

SEEDS, LARGER = 16, 20.0
NOISE = 1e-4  # m


def test_the_worst_output_counts():
    noise, parameters, simulation = np.array([3.0, 2.0]), np.array([0.0, 0.0]), np.array([4.0, 0.0])
    assert Accuracy(noise, parameters, simulation).times(np.array([5.0, 30.0])) == pytest.approx(15.0)


def test_the_noise_in_the_parameters_errs_more_in_a_larger_motion(make_model, carriage_like, noise):
    """A carriage without Coulomb friction, fitted with a noise anew each time, judged without noise where it
    moves twenty times as far: the error there is as predicted, and more than the noise."""

    class Larger(carriage_like):
        def force(self, time):
            return LARGER * super().force(time)

    plain = {"f_c": 0.0, "offset": 0.0}
    held_out = Larger(**plain).record(400, name="larger")
    level, told, found = np.array([NOISE]), [], []
    for seed in range(SEEDS):
        fitted = carriage_like(**plain).record(400, noise=noise(400, NOISE, seed=seed))
        split = by_record([fitted], [held_out], 50)
        base = refit(make_model(("viscous",)), split)
        told.append(parameter_error(base, level, Context(split)).item())
        found.append(base.score.rmse.item())
    assert np.sqrt(np.mean(np.square(found))) == pytest.approx(np.mean(told), rel=0.3)
    assert np.mean(told) > NOISE


@pytest.mark.parametrize("wider", [1.0, 4.0])
def test_the_simulation_is_to_blame_for_what_too_wide_a_smoothing_leaves(make_model, split_of, wider):
    """The truth creeps as tanh(v/epsilon) does: smoothed four times as wide, a complete model errs by it."""
    split = split_of()
    base = refit(make_model(), split)
    if wider > 1:
        base = refit(base.model, split, [base.values], base, replace(base.numerics, smoothing=wider))
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
