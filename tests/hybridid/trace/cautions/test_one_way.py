"""Horizons that judge in a direction that no fitted one has are told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.trace.cautions.one_way import judged_the_other_way
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import by_record
from hybridid.trace.refits.refit import refit

LENGTH = 50


def moved(record, direction: int):
    """``record`` as if its carriage went on and on in one direction, faster and slower."""
    way = direction * np.cumsum(0.1 + abs(np.gradient(record.outputs[:, 0])))[:, None] * 1e-2
    return replace(record, outputs=way)


@pytest.mark.parametrize(("ours", "theirs", "told"), [(1, -1, True), (-1, 1, True), (1, 1, False)])
def test_what_judges_in_a_direction_that_was_not_fitted(make_model, two_records, ours, theirs, told):
    first, second = two_records()
    split = by_record([moved(first, ours)], [moved(second, theirs)], LENGTH)
    base = refit(make_model(("viscous", "coulomb", "offset")), split)
    said = judged_the_other_way(base, Context(split))
    assert bool(said) is told
    if told:
        assert said.startswith(" Beware: what judges moves carriage in a direction that was hardly fitted")


def test_records_of_both_directions_are_fine(make_model, two_records):
    first, second = two_records()
    split = by_record([first], [second], LENGTH)
    assert judged_the_other_way(refit(make_model(), split), Context(split)) == ""
