"""What a trace says of laws that it tried."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.trace.entries import TriedEffect, Value
from hybridid.trace.words.law_words import nearest_law
from hybridid.trace.words.words import sentence

NUMBERS = {"k": Value(460.0, 20.0, "N·s/m"), "c": Value(0.433, 0.002, "m")}
LAW = TriedEffect(
    "above_of_position_times_velocity", "rod", "rejected", "", 3, 0.968, 1e-10, NUMBERS, 1.0, is_law=True
)


def test_the_refused_law_that_takes_most_is_told_with_its_numbers(nothing):
    """An engineer reads from it where the effect acts."""
    poorer = replace(LAW, effect="cube_of_position_times_velocity", gain=0.6)
    found = replace(nothing(poorer, LAW), verdict="unexplained", times=12.3)
    said = (
        " Of the formulas tried rod.above_of_position_times_velocity comes nearest: it takes 96.8 % (k = "
        "460 ± 39 N·s/m, c = 0.4330 ± 0.0039 m), and is no proposal, as its form is not shown (hybridid "
        "effects above_of_position_times_velocity prints it)."
    )
    assert nearest_law(found) == said
    assert said in sentence(found)


@pytest.mark.parametrize("other", [replace(LAW, gain=0.2), replace(LAW, is_law=False)])
def test_one_that_takes_little_or_has_a_name_is_not(nothing, other):
    assert nearest_law(nothing(other)) == ""
