"""Declared effects that end at zero are told, but not those of which one must act."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.trace.results.idle import either_of, idle_terms

VISCOUS, OFFSET = "carriage.viscous.f_v", "carriage.offset.offset"


def estimate(viscous=(200.0, 3.0), offset=(-0.3, 0.25), correlation=0.0):
    values = {VISCOUS: viscous, OFFSET: offset}
    parameters = [SimpleNamespace(name=name, value=v, std=std) for name, (v, std) in values.items()]
    return SimpleNamespace(parameters=parameters, correlation=np.array([[1, correlation], [correlation, 1]]))


@pytest.fixture(scope="module")
def model(make_model):
    return make_model(("viscous", "offset"))


def test_declared_effects_that_end_at_zero_are_told(model):
    assert idle_terms(model, estimate()) == ("carriage.offset",)
    assert idle_terms(model, estimate(offset=(-3.2, 0.25))) == ()
    assert idle_terms(model, estimate(viscous=(0.0, float("nan")))) == ("carriage.offset",)
    assert idle_terms(model, estimate(viscous=(1.0, 3.0))) == ("carriage.viscous", "carriage.offset")


def test_of_two_that_are_collinear_one_acts(model):
    """Each is 1.5 standard errors from zero, and their sum is known well."""
    one_of_two = estimate((150.0, 100.0), (150.0, 100.0), correlation=-0.99)
    assert idle_terms(model, one_of_two) == ()
    assert either_of(model, one_of_two) == ("carriage.viscous", "carriage.offset")
    neither = estimate((150.0, 100.0), (-150.0, 100.0), correlation=-0.99)
    assert len(idle_terms(model, neither)) == 2
    assert either_of(model, neither) == ()


def test_an_effect_that_is_zero_beside_two_that_are_collinear_is_told(make_model):
    model = make_model(("viscous", "offset", "added_inertia"))
    found = estimate((150.0, 100.0), (150.0, 100.0), correlation=-0.99)
    found.parameters.append(SimpleNamespace(name="carriage.added_inertia.m_a", value=0.01, std=1.0))
    found.correlation = np.pad(found.correlation, (0, 1)) + np.diag([0, 0, 1.0])
    assert idle_terms(model, found) == ("carriage.added_inertia",)
    assert either_of(model, found) == ("carriage.viscous", "carriage.offset")
