"""A simulated carriage on a spring about a centre other than zero: one effect, the sum of two others."""

from __future__ import annotations

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import admissible
from hybridid.trace.context import Context
from hybridid.trace.search.search import search

STIFFNESS, CENTRE = 400.0, 0.15
TRIED = tuple(map(effect_named, ("linear_stiffness", "preloaded_spring", "offset", "cubic_stiffness")))
DECLARED = ("viscous", "coulomb")
SPRING = "carriage.preloaded_spring"


@pytest.mark.parametrize(
    ("truth", "named"),
    [
        ({"stiffness": STIFFNESS, "centre": CENTRE, "offset": 0.0}, SPRING),
        ({"stiffness": STIFFNESS, "centre": 0.0, "offset": 0.0}, "carriage.linear_stiffness"),
        ({"stiffness": 0.0, "offset": 9.0}, "carriage.offset"),
    ],
)
def test_the_sum_is_named_where_both_are_there_and_else_the_part_that_is(make_model, split_of, truth, named):
    found = search(make_model(DECLARED), Context(split_of(n=500, **truth), TRIED), [{}])
    (one,) = found.accepted
    assert one.name == named
    assert [member.candidate.name for member in one.alike] == [named]


def test_its_zero_is_where_the_spring_is_at_rest(make_model, split_of):
    split = split_of(n=500, stiffness=STIFFNESS, centre=CENTRE, offset=0.0)
    values = search(make_model(DECLARED), Context(split, TRIED), [{}]).final.values
    assert values[f"{SPRING}.k"] == pytest.approx(STIFFNESS, rel=0.02)
    assert -values[f"{SPRING}.F_0"] / values[f"{SPRING}.k"] == pytest.approx(CENTRE, rel=0.02)


@pytest.mark.parametrize("part", ["offset", "linear_stiffness"])
def test_beside_one_of_its_parts_the_other_alone_is_tried(make_model, part):
    tried = [one.effect.id for one in admissible(make_model((*DECLARED, part)), TRIED)]
    assert "preloaded_spring" not in tried
    assert len(tried) == len(TRIED) - 2
