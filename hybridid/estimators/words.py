"""What is to say of an estimate, in words."""

from __future__ import annotations

import math

from hybridid.estimators.estimate import AllOne, Difference
from hybridid.quantities import engineering, number, probability, with_unit

SURE = 0.05
"""The p-value below which values are said to differ."""


def differs(one: Difference) -> str:
    """Whether the values of a parameter differ between groups of records, how much, and how sure that is."""
    largest = max(abs(one.lowest), abs(one.highest))
    factor, unit = engineering(largest, one.unit)
    digits = 4 if one.spread <= 0 else min(max(4, 2 + math.ceil(math.log10(largest / one.spread))), 8)
    low, high = (number(value * factor, digits) for value in (one.lowest, one.highest))
    ends = f"{low} to {with_unit(high, unit)}"
    values = f"{ends}, spread {with_unit(number(one.spread * factor, 2), unit)}"
    if math.isnan(one.test.p_value):
        return f"{one.parameter} by recording: {values}; without standard errors, nothing says if it differs"
    verb = "differs" if one.test.p_value < SURE else "does not differ noticeably"
    return f"{one.parameter} {verb} by recording: {values}, {_sure(one.test, 'it is one value')}"


def differ_together(test: AllOne) -> str:
    """Whether several parameters differ together, which may be collinear."""
    verb = "differ" if test.p_value < SURE else "do not differ noticeably"
    return f"together they {verb} by recording: {_sure(test, 'each is one value')}"


def _sure(test: AllOne, supposed: str) -> str:
    statistic = f"chi-square {number(test.chi_square, 3)} with {test.degrees}"
    return f"p {probability(test.p_value, '= ')} if {supposed} ({statistic})"
