"""What the records do not show is flagged, and only that."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from hybridid.effects.effect import Dimension, Effect, EffectParameter
from hybridid.estimators import FitSettings, fit

BASE = ("viscous", "coulomb", "offset")


def unknown(estimate) -> set[str]:
    return {p.name for p in estimate.parameters if not p.identifiable}


def test_everything_is_identifiable_where_it_is(free_run_fit, horizon_fit):
    assert not unknown(free_run_fit)
    assert not unknown(horizon_fit)


@pytest.mark.parametrize("horizon", [None, 100])
def test_the_shape_of_an_effect_that_is_not_there_is_unknown(make_model, noisy, free_run_fit, horizon):
    found = fit(make_model((*BASE, "stribeck")), [noisy], FitSettings(horizon=horizon))
    assert "carriage.stribeck.v_s" in unknown(found)
    assert not unknown(found) & {p.name for p in free_run_fit.parameters}
    assert any("carriage.stribeck.v_s is not identifiable" in note for note in found.warnings)


def test_two_names_for_one_mass_are_both_unknown_and_fully_correlated_elsewhere(
    make_model, noisy, free_run_fit
):
    """Added inertia at the only mass: M + m_a is known, neither is."""
    found = fit(make_model((*BASE, "added_inertia")), [noisy])
    assert unknown(found) == {"M", "carriage.added_inertia.m_a"}
    total = found.values["M"] + found.values["carriage.added_inertia.m_a"]
    assert total == pytest.approx(free_run_fit.values["M"], rel=1e-4)
    assert found.cost == pytest.approx(free_run_fit.cost, rel=1e-5)
    known = {p.name: p for p in found.parameters}
    for p in free_run_fit.parameters[1:]:
        assert known[p.name].std == pytest.approx(p.std, rel=0.05), "the others are as well known as ever"


@pytest.mark.parametrize("exact", [False, True])
def test_a_gain_beside_every_force_scales_them_all(carriage, make_model, noisy, exact):
    """(1 + g) u = M a + F holds for any g: five parameters, one direction that no record shows."""
    found = fit(make_model((*BASE, "input_gain")), [carriage.record() if exact else noisy])
    assert unknown(found) == {p.name for p in found.parameters}


def test_a_parameter_that_acts_on_nothing_is_unknown(make_model, noisy, free_run_fit):
    """A stop that the carriage never reaches."""
    stop = Effect(
        id="stop",
        kind="effort",
        title="a one-sided spring far away",
        equation="F = k max(q - 1 m, 0)",
        law=lambda at: at.p.k * ca.fmax(at.position - 1.0, 0.0),
        parameters=(EffectParameter("k", Dimension(1, -1), "stiffness", guess=1.0, nests=True),),
        source="this test",
        pattern="none",
    )
    found = fit(make_model().plus(stop), [noisy])
    assert unknown(found) == {"carriage.stop.k"}
    known = {p.name: p for p in found.parameters}
    assert known["carriage.stop.k"].std == np.inf
    for p in free_run_fit.parameters:
        assert known[p.name].value == pytest.approx(p.value, rel=1e-6)
        assert known[p.name].std == pytest.approx(p.std, rel=0.02)


def test_nearly_collinear_parameters_show_in_their_correlation(make_model, noisy):
    """Asymmetric Coulomb friction and an offset differ only where the velocity is small."""
    found = fit(make_model((*BASE, "asymmetric_coulomb")), [noisy])
    names = [p.name for p in found.parameters]
    pair = names.index("carriage.offset.offset"), names.index("carriage.asymmetric_coulomb.df_c")
    others = np.abs(found.correlation[pair[0]])
    assert others[pair[1]] > 0.95
    np.testing.assert_allclose(np.diag(found.correlation), 1.0, rtol=1e-12)
    np.testing.assert_allclose(found.correlation, found.correlation.T, atol=1e-12)
    assert np.linalg.eigvalsh(found.correlation).min() > -1e-9
