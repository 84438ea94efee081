"""Units in print and the prefixes that make numbers readable."""

from __future__ import annotations

import pytest

from hybridid.plotting.units import engineering, per_root_hertz, typeset


@pytest.mark.parametrize(
    ("magnitude", "unit", "factor", "printed"),
    [
        (0.25, "m", 1e3, "mm"),
        (1.0, "m", 1.0, "m"),
        (0.9999, "m", 1e3, "mm"),
        (2.6e-6, "m", 1e6, "µm"),
        (150.0, "N", 1.0, "N"),
        (5.1e6, "N/m", 1e-6, "MN/m"),
        (190.0, "N*s/m", 1.0, "N·s/m"),
        (0.02, "m/s", 1e3, "mm/s"),
        (0.3, "rad", 1e3, "mrad"),
        (5000.0, "s", 1.0, "s"),
        (0.02, "s", 1e3, "ms"),
        (0.05, "kg", 1.0, "kg"),
        (2e-5, "kg·m^2", 1e6, "10⁻⁶ kg·m²"),
        (0.5, "m²", 1.0, "m²"),
        (45.0, "deg", 1.0, "deg"),
        (0.4, "", 1.0, "–"),
        (3e7, "1", 1e-6, "10⁶"),
        (0.0, "m", 1.0, "m"),
        (float("nan"), "V", 1.0, "V"),
    ],
)
def test_the_prefix_suits_the_magnitude(magnitude, unit, factor, printed):
    assert engineering(magnitude, unit) == (pytest.approx(factor), printed)


def test_units_are_typeset():
    assert typeset("N*m/s^2") == "N·m/s²"
    assert typeset("s^-1") == "s⁻¹"
    assert typeset("ohm") == "Ω"
    assert typeset("1") == "–"


def test_spectral_densities_keep_one_fraction():
    assert per_root_hertz("m") == "m/√Hz"
    assert per_root_hertz("m/s") == "m/(s·√Hz)"
    assert per_root_hertz("") == "1/√Hz"
    assert engineering(2e-3, per_root_hertz("m/s")) == (pytest.approx(1e3), "mm/(s·√Hz)")
