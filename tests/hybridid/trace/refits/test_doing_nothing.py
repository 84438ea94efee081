"""A model that predicts no better than a constant explains nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.doubts import stand_in
from hybridid.trace.doubts.stand_in import unless_no_better_than_nothing
from hybridid.trace.refits.doing_nothing import error_of_constants, no_better_than_nothing
from hybridid.trace.search.search import search


@pytest.fixture(scope="module")
def found(make_model, split_of):
    split = split_of(df_v=80.0)
    context = Context(split, (effect_named("asymmetric_viscous"),))
    return search(make_model(), context, [{}]), context


def test_a_constant_leaves_what_each_horizon_varies(found):
    searched, context = found
    (second,) = context.split.records[1:]
    rows = second.outputs.reshape(-1, context.split.horizon)
    expected = np.sqrt(np.mean((rows - rows.mean(axis=1, keepdims=True)) ** 2))
    assert error_of_constants(searched.final, context.split) == pytest.approx([expected])
    assert not no_better_than_nothing(searched.final, context.split)
    assert unless_no_better_than_nothing(searched, context) is searched


def test_what_was_accepted_beside_a_model_that_explains_nothing_is_withdrawn(found, monkeypatch):
    searched, context = found
    monkeypatch.setattr(stand_in, "no_better_than_nothing", lambda final, split: True)
    kept = unless_no_better_than_nothing(replace(searched, stopped=""), context)
    assert kept.accepted == ()
    assert "predicts each horizon no better than a constant does" in kept.withdrawn
