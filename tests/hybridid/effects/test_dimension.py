"""Units of an effect's constants read as an engineer writes them, at any port."""

from __future__ import annotations

import pytest

from hybridid.declarations import Port
from hybridid.effects.dimension import DAMPING, EFFORT, INERTIA, STIFFNESS, VELOCITY, Dimension


@pytest.mark.parametrize(
    ("effort", "position", "units"),
    [
        ("N", "m", ["N", "N/m", "N·s/m", "kg", "m/s", "1/N"]),
        ("N·m", "rad", ["N·m", "N·m/rad", "N·m·s/rad", "kg·m²", "rad/s", "1/(N·m)"]),
        ("m³/s", "m", ["m³/s", "m²/s", "m²", "m²·s", "m/s", "s/m³"]),
        ("V/s", "V", ["V/s", "1/s", "1", "s", "V/s", "s/V"]),
        ("L/min", "cm", ["L/min", "L/(min·cm)", "L·s/(min·cm)", "L·s²/(min·cm)", "cm/s", "min/L"]),
        ("N/(m·s)", "m", ["N/(m·s)", "N/(m²·s)", "N/m²", "N·s/m²", "m/s", "m·s/N"]),
        ("sqrt(V)", "V", ["sqrt(V)", "sqrt(V)/V", "sqrt(V)·s/V", "sqrt(V)·s²/V", "V/s", "1/sqrt(V)"]),
    ],
)
def test_what_effort_and_position_have_in_common_cancels(effort, position, units):
    port = Port("here", "effort", effort, 1.0, position)
    dimensions = (EFFORT, STIFFNESS, DAMPING, INERTIA, VELOCITY, Dimension(effort=-1))
    assert [dimension.unit(port) for dimension in dimensions] == units


def test_a_power_that_is_no_integer_is_a_fraction():
    """The friction of a bearing grows with the speed to the power 2/3 (Palmgren)."""
    port = Port("bearing", "effort", "N·m", 1.0, "rad")
    assert Dimension(effort=1, position=-2 / 3, time=2 / 3).unit(port) == "N·m·s^(2/3)/rad^(2/3)"
