"""What is to say of an estimate, in words."""

from __future__ import annotations

import math

from hybridid.estimators.estimate import Difference
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
    if math.isnan(one.p_value):
        return f"{one.parameter} by recording: {values}; without standard errors, nothing says if it differs"
    test = f"chi-square {number(one.chi_square, 3)} with {one.degrees}"
    sure = f"p {probability(one.p_value, '= ')} if it is one value ({test})"
    if one.p_value < SURE:
        return f"{one.parameter} differs by recording: {values}, {sure}"
    return f"{one.parameter} does not differ noticeably by recording: {values}, {sure}"
