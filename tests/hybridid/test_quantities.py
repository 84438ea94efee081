"""Numbers and units in print: readable prefixes, honest digits, words where there is no number."""

from __future__ import annotations

from math import inf, nan

import pytest

from hybridid.quantities import (
    change,
    digits_apart,
    engineering,
    estimated,
    fixed,
    mean_and_deviation,
    mean_square,
    number,
    per_root_hertz,
    percent,
    power,
    probability,
    quantity,
    r_squared,
    share,
    span,
    squared,
    typeset,
    with_unit,
)

MISSING = (None, nan, inf, -inf)


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
        (nan, "V", 1.0, "V"),
        (1e-300, "m", 1e12, "pm"),
        (5e-324, "kg", 1.0, "kg"),
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


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (0.0, 4, "0"),
        (-0.012345, 4, "−0.01235"),
        (123456.0, 4, "123500"),
        (1234567.0, 6, "1.23457·10⁶"),
        (1234567.0, 7, "1234567"),
        (-2.1e-7, 2, "−2.1·10⁻⁷"),
        (1e-300, 4, "1·10⁻³⁰⁰"),
        (999.96, 4, "1000"),
    ],
)
def test_significant_digits(value, digits, text):
    assert number(value, digits) == text


@pytest.mark.parametrize("value", MISSING)
def test_what_is_no_number_is_a_word(value):
    assert number(value) == percent(value) == probability(value) == fixed(value, 2) == "unknown"
    assert quantity(value, "m") == "diverges"
    assert estimated(value, 0.1, "N") == "unknown"
    assert estimated(2.0, value, "N") == "2 ± ? N"
    assert mean_and_deviation(2.0, value, "N") == "2 N"
    assert power(value) == mean_square(value, "m") == r_squared(value) == ""
    assert change(1.0, value) == change(value, 1.0) == ""
    assert number(value, missing="failed") == quantity(value, "m", missing="failed") == "failed"


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (5.85e-4, "m", "585 µm"),
        (-0.0123456, "m/s", "−12.35 mm/s"),
        (0.0, "V", "0 V"),
        (0.4, "1", "0.4"),
        (3e7, "1", "30·10⁶"),
        (2e-5, "kg·m²", "20·10⁻⁶ kg·m²"),
        (1e-300, "m", "1·10⁻²⁸⁸ pm"),
    ],
)
def test_a_quantity_has_the_prefix_that_reads_best(value, unit, text):
    assert quantity(value, unit) == text


@pytest.mark.parametrize(
    ("value", "half_width", "text"),
    [
        (73.896, 8.9, "73.9 ± 8.9 N"),
        (0.0044228, 0.00103, "0.0044 ± 0.0010 N"),
        (-3.36, 0.98, "−3.36 ± 0.98 N"),
        (9.97, 0.0999, "9.97 ± 0.10 N"),  # 0.0999 rounds up to another place
        (12345.6, 123.4, "12350 ± 120 N"),
        (0.0123, 5.0, "0.0 ± 5.0 N"),
        (1.234e-7, 2.1e-8, "(1.23 ± 0.21)·10⁻⁷ N"),
        (-2.5e7, 1.2e5, "(−2.500 ± 0.012)·10⁷ N"),
        (0.0, 1e-9, "(0.0 ± 1.0)·10⁻⁹ N"),
        (73.9, 1e-9, "73.9 ± 1·10⁻⁹ N"),
        (0.02, 5e-7, "0.02000000 ± 5·10⁻⁷ N"),
        (2.0, 0.0, "2 ± 0 N"),
    ],
)
def test_value_and_uncertainty_end_at_the_same_place(value, half_width, text):
    assert estimated(value, half_width / 1.96, "N") == text


def test_estimates_without_a_unit_have_none():
    assert estimated(0.5, 0.01, "1") == "0.500 ± 0.020"


def test_a_mean_and_its_deviation_share_a_prefix():
    assert mean_and_deviation(0.0107, 0.00091, "m/s") == "10.70 ± 0.91 mm/s"
    assert mean_and_deviation(0.0107, None, "m/s") == "10.7 mm/s"
    assert mean_and_deviation(2e-5, 1e-6, "kg·m²") == "(20.0 ± 1.0)·10⁻⁶ kg·m²"


@pytest.mark.parametrize(
    ("p", "text"),
    [(0.0312, "0.031"), (1.0, "1"), (4.2e-6, "4.20·10⁻⁶"), (1e-16, "< 10⁻¹⁵"), (0.0, "< 10⁻¹⁵")],
)
def test_p_values(p, text):
    assert probability(p) == text
    assert probability(p, "= ") == (text if text.startswith("<") else f"= {text}")


def test_shares_and_changes():
    assert (percent(0.05), percent(0.07), percent(0.125, 1), percent(0.0)) == ("5 %", "7 %", "12.5 %", "0 %")
    assert percent(-0.272, 1) == "−27.2 %"
    assert (share(0.361), share(-0.5), share(-1.0), share(-7.0)) == (
        "36.1 %",
        "−50.0 %",
        "diverges",
        "diverges",
    )
    assert (change(2.0, 1.0), change(1.0, 1.234, 0), change(1.0, 1.0)) == ("−50.0 %", "+23 %", "0.0 %")
    assert change(1.0, 1.0 - 1e-6) == "0.0 %"
    assert change(0.0, 1.0) == ""


def test_nearly_all_does_not_read_as_all():
    assert (share(0.9994), share(0.9997), share(0.999996), share(1.0)) == (
        "99.9 %",
        "99.97 %",
        "99.9996 %",
        "100.0 %",
    )
    assert (change(1.0, 3e-4), change(1.0, 4e-3, 0), change(1.0, 0.0)) == ("−99.97 %", "−99.6 %", "−100.0 %")


def test_mean_squares_and_coefficients_of_determination():
    assert mean_square(2.09e-7, "m/s") == "2.090·10⁻⁷ (m/s)²"
    assert mean_square(0.0, "m") == "0 m²"
    assert mean_square(0.5, "1") == "5.000·10⁻¹"
    assert (r_squared(0.99987654), r_squared(-3.0)) == ("0.999877", "−3.000000")
    assert r_squared(-1.2244e160) == "−1.22·10¹⁶⁰"
    assert (squared("m"), squared("N·m"), squared("")) == ("m²", "(N·m)²", "")


def test_units_stand_behind_numbers():
    assert (with_unit("3", "N*m"), with_unit("3", ""), with_unit("3", "1")) == ("3 N·m", "3", "3")


def test_zero_has_no_sign():
    assert share(-0.0004) == "0.0 %"
    assert share(-0.0006) == "−0.1 %"
    assert fixed(-0.004, 2) == "0.00"


@pytest.mark.parametrize(
    ("ends", "said"),
    [((-0.809, 1.5), "−0.809 to 1.5 m/s"), ((-2e-6, 3e-3), "−0.002 to 3 mm/s"), ((0.0, 0.0), "0 to 0 m/s")],
)
def test_a_range_has_one_unit(ends, said):
    assert span(*ends, "m/s", 3).replace("\N{NO-BREAK SPACE}", " ") == said


@pytest.mark.parametrize(
    ("low", "high", "digits"),
    [
        (20000.13, 20001.13, 6),
        (0.0999, 0.1001, 5),
        (-1.0, 1.0, 5),
        (1.0, 1.0, 5),
        (1.0, float("nan"), 5),
        (1.0, 1.0 + 1e-15, 12),
    ],
)
def test_the_ends_of_an_interval_differ_in_print(low, high, digits):
    assert digits_apart(low, high, least=5) == digits
