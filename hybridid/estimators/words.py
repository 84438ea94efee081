"""What is to say of an estimate, in words."""

from __future__ import annotations

import math

from hybridid.estimators.estimate import Difference
from hybridid.quantities import engineering, number, probability, with_unit

SURE = 0.05
"""The p-value below which values are said to differ."""


def differs(one: Difference) -> str:
    """Whether the values of a parameter differ between groups of records, how much, and how sure that is."""
    factor, unit = engineering(max(abs(one.lowest), abs(one.highest)), one.unit)
    ends = f"{number(one.lowest * factor)} to {with_unit(number(one.highest * factor), unit)}"
    values = f"{ends}, spread {with_unit(number(one.spread * factor, 2), unit)}"
    if math.isnan(one.p_value):
        return f"{one.parameter} by recording: {values}; without standard errors, nothing says if it differs"
    test = f"chi-square {number(one.chi_square, 3)} with {one.degrees}"
    sure = f"p {probability(one.p_value, '= ')} if it is one value ({test})"
    if one.p_value < SURE:
        return f"{one.parameter} differs by recording: {values}, {sure}"
    return f"{one.parameter} does not differ noticeably by recording: {values}, {sure}"
