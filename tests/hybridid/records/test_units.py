"""Units as people write them."""

from __future__ import annotations

import math

import pytest

from hybridid.records.units import factor, is_unit


@pytest.mark.parametrize(
    ("unit", "into", "expected"),
    [
        ("deg", "rad", math.pi / 180),
        ("°", "rad", math.pi / 180),
        ("mrad", "rad", 1e-3),
        ("rpm", "rad/s", math.pi / 30),
        ("rev/s", "rad/s", 2 * math.pi),
        ("mm/s2", "m/s²", 1e-3),
        ("mm/s^2", "m/s²", 1e-3),
        ("mNm", "N·m", 1e-3),
        ("Nm", "N*m", 1.0),
        ("kN", "N", 1e3),
        ("L/min", "m³/s", 1e-3 / 60),
        ("g_0", "m/s²", 9.80665),
        ("%", "1", 0.01),
        ("usec", "s", 1e-6),
        ("m^2.5/s", "m^2.5/s", 1.0),
    ],
)
def test_a_unit_is_converted(unit, into, expected):
    assert factor(unit, into) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("unit", "into"),
    [
        ("A", "N·m"),  # another quantity
        ("counts", "rad"),  # pint holds both to be pure numbers
        ("1/s", "rad/s"),
        ("rad", "1"),
        ("°C", "K"),  # no factor alone
        ("furlongs of rope", "m"),
        ("x[", "m"),
        ("3", "m"),
        ("", "m"),
    ],
)
def test_what_no_factor_turns_into_the_other_is_none(unit, into):
    assert factor(unit, into) is None


def test_words_are_no_units():
    assert is_unit("N·m")
    assert not any(is_unit(word) for word in ("angle", "position", "", "motor current"))
