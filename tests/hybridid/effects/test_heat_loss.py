"""Losses of heat that grow faster than the temperature."""

from __future__ import annotations

import numpy as np
import pytest

STEFAN_BOLTZMANN = 5.670374e-8  # W/(m² K⁴)


def test_natural_convection_grows_with_the_power_of_five_quarters(bench):
    loss = bench("natural_convection", k=2.0, q_r=10.0)
    assert loss.law(position=10.0) == pytest.approx(20.0, rel=1e-6)
    for q in (5.0, 40.0):
        assert loss.law(position=2 * q) / loss.law(position=q) == pytest.approx(2**1.25, rel=1e-5)
        assert loss.law(position=-q) == -loss.law(position=q)
    assert loss.law(position=0.0) == 0.0


def test_radiation_is_the_law_of_stefan_and_boltzmann(bench):
    area, emissivity, around = 0.05, 0.9, 293.0
    k = 4 * emissivity * STEFAN_BOLTZMANN * area * around**3
    loss = bench("thermal_radiation", k=k)
    for q in (-30.0, 0.0, 60.0, 400.0):
        wanted = emissivity * STEFAN_BOLTZMANN * area * ((around + q) ** 4 - around**4)
        assert loss.law(position=q) == pytest.approx(wanted, rel=1e-9, abs=1e-9)
    assert np.gradient([loss.law(position=q) for q in (-0.1, 0.0, 0.1)], 0.1)[1] == pytest.approx(k, rel=1e-6)
