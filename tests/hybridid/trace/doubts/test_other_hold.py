"""An assumed hold of the input that explains what is left."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.trace.context import Context
from hybridid.trace.doubts.other_hold import better_hold
from hybridid.trace.refits.numerics import Numerics
from hybridid.trace.refits.refit import refit


@pytest.fixture(scope="module")
def assumed(split_of):
    """The carriage's force was held; its records do not say so."""
    split = split_of()
    records = tuple(
        replace(r, input_channels=tuple(replace(c, assumed=True) for c in r.input_channels))
        for r in split.records
    )
    return replace(split, records=records)


def test_the_true_hold_is_told_where_another_was_assumed(make_model, assumed):
    wrong = tuple(
        replace(r, input_channels=tuple(replace(c, hold="foh") for c in r.input_channels))
        for r in assumed.records
    )
    split = replace(assumed, records=wrong)
    said = better_hold(refit(make_model(), split), Context(split))
    assert said.startswith(
        " Beware: how force runs between samples is not declared, and foh is assumed. With zoh"
    )
    assert said.endswith("set signals.inputs.force.hold=zoh and trace again.")


def test_nothing_is_told_where_the_assumed_hold_is_right(make_model, assumed):
    assert better_hold(refit(make_model(), assumed), Context(assumed)) == ""


def test_a_declared_hold_is_not_doubted(make_model, split_of):
    split = split_of()
    base = refit(make_model(), split, numerics=Numerics(hold=None))
    assert all(not c.assumed for r in split.records for c in r.input_channels)
    assert better_hold(base, Context(split)) == ""
