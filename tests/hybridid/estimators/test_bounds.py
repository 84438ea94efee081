"""Bounds are honoured to the last digit, and whoever stands at one is flagged."""

from __future__ import annotations

import pytest

from hybridid.estimators import FitSettings, fit

METHODS = ("gauss_newton", "multiple_shooting")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("side", "bound"), [("upper", 15.0), ("lower", 25.0)])
def test_an_active_bound_is_reached_flagged_and_the_rest_is_optimal(make_model, noisy, method, side, bound):
    name = "carriage.coulomb.f_c"
    found = fit(make_model(adjust={name: {side: bound}}), [noisy], FitSettings(method=method))
    at = {p.name: p for p in found.parameters}
    assert at[name].at_bound
    assert at[name].value == pytest.approx(bound, rel=1e-6)
    assert at[name].value <= bound if side == "upper" else at[name].value >= bound
    assert [p.name for p in found.parameters if p.at_bound] == [name]
    assert any(f"{name} = {bound:g} N is at a bound" in note for note in found.warnings)
    held = fit(make_model(adjust={name: {"fixed": bound}}), [noisy])
    assert found.cost == pytest.approx(held.cost, rel=1e-5)
    for p in held.parameters:
        assert at[p.name].value == pytest.approx(p.value, rel=1e-4), p.name


def test_bounds_that_do_not_bind_change_nothing(make_model, noisy, free_run_fit):
    wide = make_model(adjust={"carriage.coulomb.f_c": {"lower": 5.0, "upper": 60.0}})
    found = fit(wide, [noisy])
    assert not any(p.at_bound for p in found.parameters)
    assert found.cost == pytest.approx(free_run_fit.cost, rel=1e-7)


def test_a_start_outside_the_bounds_is_brought_inside(make_model, noisy, free_run_fit):
    model = make_model(adjust={"M": {"lower": 60.0, "upper": 120.0}})
    found = fit(model, [noisy], start_values={"M": 500.0})
    assert found.values["M"] == pytest.approx(free_run_fit.values["M"], rel=1e-4)


@pytest.mark.parametrize("method", METHODS)
def test_a_parameter_without_a_bound_below_may_be_negative(make_model, noisy, method):
    """The offset is -3.2 N: its sign is for the data to say."""
    found = fit(make_model(), [noisy], FitSettings(method=method))
    assert found.values["carriage.offset.offset"] == pytest.approx(-3.2, rel=0.01)
