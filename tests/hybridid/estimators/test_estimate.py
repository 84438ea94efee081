"""An estimate survives its way through JSON, infinities included."""

from __future__ import annotations

import json

import numpy as np
import pytest

from hybridid.estimators import Estimate, FitSettings, fit
from hybridid.plain import plain, restored


@pytest.mark.parametrize(
    "effects", [("viscous", "coulomb", "offset"), ("viscous", "coulomb", "offset", "added_inertia")]
)
def test_there_and_back_again(make_model, noisy, effects):
    first = fit(make_model(effects), [noisy], FitSettings(horizon=150, starts=2, continuation=(3.0, 1.0)))
    again = restored(Estimate, json.loads(json.dumps(plain(first), allow_nan=False)), "estimate.json")
    assert plain(again) == plain(first)
    # null stands for every standard error that is not finite
    assert repr(again.parameters) == repr(first.parameters).replace("std=inf", "std=nan")
    assert again.settings == first.settings
    assert again.values == first.values
    assert again.origin == first.origin
    np.testing.assert_array_equal(again.correlation, first.correlation)
    np.testing.assert_array_equal(again.initial_states, first.initial_states)


def test_the_promised_keys_are_there(free_run_fit):
    written = plain(free_run_fit)
    assert {"parameters", "cost", "status", "iterations", "seconds"} <= set(written)
    assert set(written["seconds"]) == {"build", "solve", "check"}
    for entry in written["parameters"].values():
        assert {"value", "std", "unit", "lower", "upper", "at_bound"} <= set(entry)
    assert written["parameters"]["carriage.viscous.f_v"]["unit"] == "N·s/m"


def test_the_cost_is_half_the_sum_of_squares_over_the_outputs_spread(free_run_fit, noisy, symmetric):
    from hybridid.simulation import simulate

    run = simulate(
        symmetric, free_run_fit.values, noisy, free_run_fit.initial_states[0], free_run_fit.substeps
    )
    error = (noisy.outputs - run.outputs) / noisy.outputs.std()
    assert free_run_fit.cost == pytest.approx(0.5 * np.sum(error**2), rel=1e-9)
    assert free_run_fit.history[-1] == pytest.approx(free_run_fit.cost, rel=1e-12)
    assert np.all(np.diff(free_run_fit.history) <= 0)
