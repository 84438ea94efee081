"""Of laws with known formulas: whether each is a function of one variable, times a function of the others."""

from __future__ import annotations

import pytest

from hybridid.declarations import Signal
from hybridid.effects.library import effect_named
from hybridid.effects.over import Over
from hybridid.trace.learned.separable import is_separable

SIZES = {"velocity": 0.3, "drive": 20.0, "load": 20.0}


def separable(name: str, variable: str, **parameters: float) -> bool:
    constants = {**parameters, "epsilon": 1e-3, "load_width": 0.01}
    return is_separable(effect_named(name), constants, Over(variable), SIZES)


@pytest.mark.parametrize("variable", ["velocity", "load"])
def test_friction_that_grows_with_the_load_is_a_function_of_each(variable):
    assert separable("load_stribeck", variable, mu_s=0.1, v_s=0.1)
    assert separable("load_friction", variable, mu=0.1)


def test_a_law_of_other_variables_is_none_of_this_one():
    assert not separable("coulomb", "position", f_c=3.0)
    assert not separable("coulomb", "load", f_c=3.0)
    assert separable("coulomb", "velocity", f_c=3.0)


def test_a_sum_of_two_functions_is_no_product():
    """F = m a + m' v^2 / 2, m a function of the position."""
    assert not separable("varying_inertia", "position", m_1=0.2, m_2=0.1, q_0=0.0)


def test_a_law_with_a_state_is_not_looked_at():
    assert not separable("dahl", "velocity", f_c=3.0, sigma=1e4)


def test_a_channel_that_the_law_does_not_see_is_none_of_its_variables():
    over = Over("input", signal=Signal("temperature", "°C"))
    assert not is_separable(effect_named("coulomb"), {"f_c": 3.0, "epsilon": 1e-3}, over, SIZES)
