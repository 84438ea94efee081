"""Machine code and CasADi's interpreter give the same numbers."""

from __future__ import annotations

import errno
from dataclasses import replace

import numpy as np
import pytest

from hybridid.simulation import compiler, machine_code
from hybridid.simulation.c_code import Unwritten
from hybridid.simulation.machine_code import LANES
from hybridid.simulation.shooter import Shooter
from hybridid.simulation.windows import cut

FREE = ("carriage.coulomb.f_c", "M", "carriage.dahl.s")
compiled = pytest.mark.skipif(compiler.c_compiler() is None, reason="no C compiler on this machine")


@pytest.fixture(autouse=True)
def always(monkeypatch):
    """Compile whatever the work."""
    monkeypatch.setattr(machine_code, "WORTH", 0.0)


def shooter_of(carriage, make_model, hold="zoh", integrator="rk4"):
    made = carriage.record(150)
    made = replace(made, input_channels=(replace(made.input_channels[0], hold=hold),))
    model = make_model(("viscous", "coulomb", "offset", "dahl", "sensor_lag", "input_saturation"))
    return Shooter(model, cut([made], 60, 4), FREE, integrator)


@compiled
@pytest.mark.parametrize("integrator", ["rk4", "rodas3"])
@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_the_same_numbers_as_interpreted(carriage, make_model, hold, integrator):
    shooter = shooter_of(carriage, make_model, hold, integrator)
    model = shooter.model
    x0 = np.random.default_rng(1).normal(size=(shooter.windows.count, len(model.states))) * 1e-3
    for sensitivities in (False, True):
        ours = shooter(x0, model.values(), sensitivities)
        theirs = shooter._interpreted(x0, model.values(), sensitivities)
        assert shooter.code.worth_it
        for name in ("outputs", "states", "final", "by_state", "by_parameter"):
            a, b = getattr(ours, name), getattr(theirs, name)
            np.testing.assert_allclose(a, b, rtol=1e-10, atol=1e-12 * np.abs(b).max(initial=1e-300))


@compiled
def test_other_horizons_share_the_code(carriage, make_model):
    shooter = shooter_of(carriage, make_model)
    x0, p = np.zeros((shooter.windows.count, len(shooter.model.states))), shooter.model.values()
    some = shooter.over(shooter.windows.select([1]))
    assert some.code is shooter.code
    np.testing.assert_array_equal(some(x0[[1]], p).outputs, shooter(x0, p).outputs[[1]])


@compiled
def test_a_horizon_that_leaves_the_numbers_is_blank_from_there_on(carriage, make_model):
    model = make_model(("cubic_stiffness",))
    shooter = Shooter(model, cut([carriage.record(100)], 50, 1), ("M",))
    x0 = np.array([[1.0, 0.0], [0.0, 0.0]])
    shot = shooter(x0, model.values({"carriage.cubic_stiffness.k_3": -1e9}), sensitivities=True)
    assert np.isfinite(shot.outputs[0, 0]).all()
    assert not np.isfinite(shot.outputs[0, -1]).any()
    assert np.isfinite(shot.outputs[1]).all()


@compiled
@pytest.mark.parametrize("horizons", [2, 4, 20])
def test_products_of_the_sensitivities_are_those_of_the_sensitivities(carriage, make_model, horizons):
    model = make_model(("viscous", "coulomb", "sensor_lag"))
    shooter = Shooter(model, cut([carriage.record(20 * horizons)], 20, 1), ("M", "carriage.coulomb.f_c"))
    x0, p = np.full((horizons, len(model.states)), 1e-3), model.values()
    weights = np.random.default_rng(0).uniform(1, 2, shooter.windows.outputs.shape)
    weights[0, 3:5] = weights[-1, 10:] = 0.0
    outputs = np.where(weights > 0, shooter.windows.outputs, np.nan)  # what does not count may be missing
    whole = shooter(x0, p, sensitivities=True)
    apart = replace(shooter, windows=replace(shooter.windows, outputs=outputs))
    apart = apart.compared(x0, p, weights, sensitivities=True)
    assert apart.multiplied
    by = np.concatenate([whole.by_state, whole.by_parameter], axis=3) * weights[..., None]
    left = np.where(weights > 0, (outputs - whole.outputs) * weights, 0.0)
    square, error = np.einsum("whki,whkj->wij", by, by), np.einsum("whki,whk->wi", by, left)
    spent = np.einsum("whk,whk->w", left, left)
    for ours, theirs in ((apart.square, square), (apart.error, error), (apart.spent, spent)):
        np.testing.assert_allclose(ours, theirs, rtol=1e-11, atol=1e-12 * np.abs(theirs).max())


@compiled
def test_products_of_a_horizon_that_leaves_the_numbers_are_none(carriage, make_model):
    model = make_model(("cubic_stiffness",))
    shooter = Shooter(model, cut([carriage.record(100)], 50, 1), ("M",))
    x0, p = np.array([[1.0, 0.0], [0.0, 0.0]]), model.values({"carriage.cubic_stiffness.k_3": -1e9})
    assert np.isnan(shooter(x0, p).outputs[0]).any()
    weights = np.ones(shooter.windows.outputs.shape)
    shot = shooter.compared(x0, p, weights, sensitivities=True)
    assert np.isnan(shot.square[0]).all()
    assert np.isfinite(shot.square[1]).all()
    np.testing.assert_array_equal(np.isnan(shot.spent), [True, False])
    weights[0, 1:] = 0.0  # as beyond a record's end
    assert np.isfinite(shooter.compared(x0, p, weights, sensitivities=True).square).all()


@compiled
@pytest.mark.parametrize("horizons", [2, 20])
def test_a_simulation_stops_above_a_limit_and_only_there(carriage, make_model, horizons):
    windows = cut([carriage.record(20 * horizons)], 20, 1)
    shooter = Shooter(make_model(("viscous", "coulomb")), windows, ("M",))
    x0, p = np.full((horizons, len(shooter.model.states)), 1e-2), shooter.model.values()
    weights = np.ones(shooter.windows.outputs.shape)
    whole = shooter.compared(x0, p, weights, sensitivities=False).spent
    total = whole.sum() * (1 + 1e-12)
    np.testing.assert_array_equal(shooter.compared(x0, p, weights, False, limit=total).spent, whole)
    for share in (0.01, 0.5, 0.99):
        assert np.isinf(shooter.compared(x0, p, weights, False, limit=share * total).spent).all()


def test_without_a_compiler_everything_is_interpreted(carriage, make_model, monkeypatch):
    monkeypatch.setattr(machine_code, "c_compiler", lambda: None)
    shooter = shooter_of(carriage, make_model)
    x0 = np.zeros((shooter.windows.count, len(shooter.model.states)))
    assert not shooter.code.worth_it
    assert shooter(x0, shooter.model.values()).outputs.shape == (*shooter.windows.used.shape, 1)


def test_a_compiler_that_fails_is_named_once(carriage, make_model, monkeypatch, tmp_path):
    broken = tmp_path / "cc"
    broken.write_text("#!/bin/sh\necho no such option >&2\nexit 1\n")
    broken.chmod(0o755)
    monkeypatch.setattr(compiler, "c_compiler", lambda: str(broken))
    monkeypatch.setattr(compiler, "_LIBRARIES", {})
    shooter = shooter_of(carriage, make_model)
    with pytest.warns(UserWarning, match="fails \\(no such option\\): models are interpreted"):
        assert not shooter.code.worth_it


@compiled
@pytest.mark.parametrize("lanes", [1, 4])
@pytest.mark.parametrize("integrator", ["rk4", "rodas3"])
def test_what_is_written_gives_a_compiler_nothing_to_warn_of(
    carriage, make_model, integrator, lanes, monkeypatch
):
    """What one compiler warns of, the next version of it refuses."""
    strict = (*compiler._flags(), "-Wall", "-Wno-unused-function", "-Werror")
    monkeypatch.setattr(compiler, "_flags", lambda: strict)
    monkeypatch.setattr(compiler, "_LIBRARIES", {})
    code = replace(shooter_of(carriage, make_model, integrator=integrator).code, lanes=lanes)
    assert code.worth_it


def test_on_a_full_disk_nothing_is_interpreted(carriage, make_model, monkeypatch, tmp_path):
    """It would have other last digits than the results that the same command kept before, and after."""
    full = tmp_path / "cc"
    full.write_text("#!/bin/sh\necho $TMPDIR/x.o: No space left on device >&2\necho ended >&2\nexit 1\n")
    full.chmod(0o755)
    monkeypatch.setattr(compiler, "c_compiler", lambda: str(full))
    monkeypatch.setattr(compiler, "_LIBRARIES", {})
    with pytest.raises(OSError, match="No space left") as raised:
        _ = shooter_of(carriage, make_model).code.worth_it
    assert raised.value.errno == errno.ENOSPC


@compiled
def test_one_lane_and_four_give_the_same_numbers(carriage, make_model):
    """Handed-on states, horizons of three records, one of them short: lanes are left over."""
    records = [carriage.record(n) for n in (150, 90, 130)]
    model = make_model(("viscous", "coulomb", "dahl"))
    inner = (len(model.states) - 1,)
    shooter = Shooter(model, cut(records, 60, 2), ("M", "carriage.dahl.s"), carried=inner)
    assert shooter.code.lanes == LANES
    alone = replace(shooter)
    alone.__dict__["code"] = replace(shooter.code, lanes=1)
    x0 = np.random.default_rng(2).normal(size=(shooter.windows.count, len(model.states))) * 1e-3
    ours, theirs = (one(x0, model.values(), sensitivities=True) for one in (shooter, alone))
    for name in ("outputs", "states", "final", "by_state", "by_parameter", "ends_by"):
        a, b = getattr(ours, name), getattr(theirs, name)
        np.testing.assert_allclose(a, b, rtol=1e-10, atol=1e-12 * np.abs(b).max())


@pytest.mark.parametrize("lanes", [1, 4])
def test_a_block_comes_after_those_that_its_horizons_follow(lanes):
    follows = (-1, 0, 1, -1, 3, -1, -1, -1, 7)
    blocks = machine_code._blocks(follows, lanes)
    place = {int(k): g for g, row in enumerate(blocks) for k in row if k >= 0}
    assert sorted(place) == list(range(9))
    assert all(place[k] > place[before] for k, before in enumerate(follows) if before >= 0)
    assert (blocks[:, 0] >= 0).all()


@compiled
def test_problems_of_one_model_share_their_functions(carriage, make_model):
    first = shooter_of(carriage, make_model)
    other = replace(first, windows=cut([carriage.record(150)], 60, 4))
    assert first.code is not other.code
    assert first.code.parts is other.code.parts
    assert replace(first, free=("M",)).code.parts is not first.code.parts


@compiled
def test_c_is_written_only_of_what_is_not_yet_compiled(carriage, make_model, monkeypatch):
    shooter = shooter_of(carriage, make_model)
    assert shooter.code.worth_it
    monkeypatch.setattr(compiler, "_LIBRARIES", {})
    monkeypatch.setattr(machine_code, "c_of_parts", None)
    again = replace(shooter, model=replace(shooter.model))
    x0, p = np.zeros((again.windows.count, len(again.model.states))), again.model.values()
    np.testing.assert_array_equal(again(x0, p).outputs, shooter(x0, p).outputs)


@compiled
def test_an_operation_without_c_is_interpreted(carriage, make_model, monkeypatch):
    def refuse(*given):
        raise Unwritten("no C")

    monkeypatch.setattr(machine_code, "c_of_parts", refuse)
    monkeypatch.setattr(compiler, "_LIBRARIES", {})
    monkeypatch.setattr(compiler, "library", lambda key, build: build(None))
    with pytest.warns(UserWarning, match="no C: the model is interpreted"):
        assert not shooter_of(carriage, make_model).code.worth_it
