"""Inner states run on from horizon to horizon, and so does how they depend on the parameters."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.simulation import machine_code
from hybridid.simulation.shooter import Shooter
from hybridid.simulation.windows import cut

FREE = ("M", "carriage.maxwell.k", "carriage.maxwell.tau")
CARRIED = (2,)
WAYS = [
    pytest.param(
        True,
        marks=pytest.mark.skipif(machine_code._compiler() is None, reason="no C compiler on this machine"),
        id="compiled",
    ),
    pytest.param(False, id="interpreted"),
]


@pytest.fixture(params=WAYS)
def shooter(request, monkeypatch, carriage, make_model):
    """Horizons of 70 samples, which calls of 2500 do not divide; the last of the record is shorter."""
    monkeypatch.setattr(machine_code, "WORTH", 0.0 if request.param else np.inf)
    model = make_model(("viscous", "maxwell"))
    return Shooter(model, cut([carriage.record(180), carriage.record(150)], 70, 2), FREE, "rk4", CARRIED)


def start_of(shooter):
    x0 = np.zeros((shooter.windows.count, 3))
    x0[:, 1] = np.random.default_rng(2).normal(size=len(x0)) * 0.1
    return x0


def values_of(shooter, **changed):
    values = {"carriage.maxwell.k": 300.0, "carriage.maxwell.tau": 0.2}
    return shooter.model.values({**values, **changed})


def test_a_state_goes_on_where_the_horizon_before_has_left_it(shooter):
    windows = shooter.windows
    assert windows.follows == (-1, 0, 1, -1, 3)
    shot = shooter(start_of(shooter), values_of(shooter))
    ends = shot.ends(windows)
    for k, before in enumerate(windows.follows):
        assert shot.states[k, 0, 2] == (0.0 if before < 0 else ends[before, 2])
    assert np.abs(shot.states[[1, 2, 4], 0, 2]).min() > 0
    np.testing.assert_array_equal(shot.states[:, 0, :2], start_of(shooter)[:, :2])


def test_what_follows_nothing_among_the_horizons_begins_as_given(shooter):
    x0 = start_of(shooter)
    x0[:, 2] = 0.01
    some = shooter.over(shooter.windows.select([1, 2, 4]))
    begun = some(x0[[1, 2, 4]], values_of(shooter)).states[:, 0, 2]
    assert begun[0] == 0.01
    assert begun[1] != 0.01
    assert begun[2] == 0.01


def test_sensitivities_run_on_too(shooter):
    x0, names = start_of(shooter), [p.name for p in shooter.model.parameters]
    p = values_of(shooter)
    shot = shooter(x0, p, sensitivities=True)
    assert np.abs(shot.by_state[[1, 2, 4], ..., 2]).max() == 0.0
    for k, name in enumerate(FREE):
        nudge = np.zeros(len(p))
        nudge[names.index(name)] = 1e-4 * p[names.index(name)]
        up, down = shooter(x0, p + nudge).outputs, shooter(x0, p - nudge).outputs
        slope = (up - down) / (2 * nudge.max())
        np.testing.assert_allclose(
            shot.by_parameter[..., k], slope, rtol=1e-4, atol=1e-6 * np.abs(slope).max()
        )


def test_a_horizon_that_left_the_numbers_hands_nothing_on(shooter):
    x0 = start_of(shooter)
    x0[0, 1] = np.inf
    x0[:, 2] = 0.02
    assert shooter(x0, values_of(shooter)).states[1, 0, 2] == 0.02
