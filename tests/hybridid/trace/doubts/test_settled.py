"""A search that ends at the noise is doubted where a learned effort still takes a part of that noise."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.simulation.stability import MOST
from hybridid.trace.context import Context
from hybridid.trace.doubts import settled
from hybridid.trace.doubts.settled import Settled
from hybridid.trace.rules import Rules
from hybridid.trace.search.steps import AT_FLOOR, NONE_PASSES, OUT_OF_TIME
from hybridid.trace.verdict import _verdict, conclude

DF_V = 80.0
TRIED = tuple(map(effect_named, ("asymmetric_viscous", "cubic_stiffness")))


@pytest.fixture(scope="module")
def context(split_of):
    """All that is missing is taken for noise."""
    return Context(split_of(df_v=DF_V), TRIED, Rules(near_floor=1e6), variables=("velocity", "position"))


@pytest.fixture(scope="module")
def below(make_model, context):
    return conclude(make_model(), context)


def test_what_is_taken_for_noise_and_is_not_is_named(below):
    assert [one.name for one in below.accepted] == ["carriage.asymmetric_viscous"]
    assert below.search.first.score.loss > 10 * below.search.final.score.loss


def test_what_is_noise_stays_noise(make_model, split_of, context):
    nothing = conclude(make_model(), replace(context, split=split_of()))
    assert (nothing.verdict, nothing.search.steps, nothing.search.stopped) == (
        "nothing_missing",
        (),
        AT_FLOOR,
    )


def test_the_fitted_horizons_count_too(below):
    """Where they leave far more than noise, what judges shows too little of the machine."""
    assert np.isfinite(below.times_fitted)
    nothing = replace(below.search, accepted=(), withdrawn="")
    left = Settled(nothing, (), (), below.accuracy, times=1.0, remains=())
    for times, verdict in ((2.9, "nothing_missing"), (3.1, "undecided")):
        assert _verdict(left, "", None, times, Rules()) == verdict


def test_names_that_are_left_are_doubted_again(monkeypatch):
    """Of three one is withdrawn, then another one; the last stays."""
    left, asked = iter([2, 1, 1]), []

    def doubted(found, context):
        asked.append(len(found.accepted))
        return SimpleNamespace(found=SimpleNamespace(accepted=[None] * next(left)))

    monkeypatch.setattr(settled, "_doubted", doubted)
    settled.settle(SimpleNamespace(accepted=[None] * 3), context=None)
    assert asked == [3, 2, 1]


def test_a_model_at_the_noise_in_many_steps_is_not_held_against_learned_efforts(below, context, monkeypatch):
    """Each would take minutes, and what such a model leaves is white."""
    monkeypatch.setattr(settled, "ceilings", lambda model, context, promised: ("asked",))
    sharp = replace(below.search.final, substeps=MOST + 1)
    ended = replace(below.search, final=sharp, stopped=AT_FLOOR)
    assert settled.learned_beside(sharp, ended, context) == ()
    assert settled.learned_beside(sharp, replace(ended, stopped=NONE_PASSES), context) == ("asked",)
    usual = replace(sharp, substeps=MOST)
    assert settled.learned_beside(usual, replace(ended, final=usual), context) == ("asked",)


def test_few_learned_efforts_are_fitted_where_no_name_is_to_be_doubted(below, context):
    named, nothing = below.search, replace(below.search, accepted=())
    late = replace(context, until=0.0)
    at_noise, far = (replace(nothing, stopped=why) for why in (AT_FLOOR, NONE_PASSES))
    last = below.search.final
    doubted = replace(named, stopped=NONE_PASSES)
    assert settled._to_promise(last, doubted, late) is None, "a name is doubted as always"
    assert settled._to_promise(last, replace(named, stopped=OUT_OF_TIME), late) is None, "near the noise too"
    assert settled._to_promise(last, far, context) is None
    assert settled._to_promise(last, far, late) == np.inf
    assert settled._to_promise(last, at_noise, context) == context.rules.worth


def test_few_learned_efforts_are_fitted_where_a_limit_leaves_the_verdict_open(below, context, monkeypatch):
    """It cut the search far from the noise, so no doubt changes what is said."""
    late, cut = replace(context, until=0.0), replace(below.search, stopped=OUT_OF_TIME)
    monkeypatch.setattr(settled, "_error_left", lambda *_: (None, 2 * context.rules.far))
    assert settled._to_promise(cut.final, cut, late) == np.inf


def test_a_name_at_the_noise_is_doubted_by_efforts_that_could_accuse_it(below, context):
    """One that took little is accused by little: with half the share that ``stands_in`` allows."""
    found, rules = replace(below.search, stopped=AT_FLOOR), context.rules
    last, (one,) = found.final, found.accepted
    assert settled._to_promise(found.first, found, context) is None, "far from the noise any may tell"
    assert settled._to_promise(last, found, context) == rules.worth
    took = 0.1 * last.score.loss**2
    little = replace(one, trial=SimpleNamespace(taken=took))
    least = settled._to_promise(last, replace(found, accepted=(little,)), context)
    both = took + 2 * least * last.score.loss**2
    assert 2 * least * last.score.loss**2 == pytest.approx(rules.stands_in * both)
