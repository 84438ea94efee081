"""A time limit ends a search between its trials, and the sentence says so."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import count
from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.run import trace
from hybridid.trace.search import search
from hybridid.trace.search.steps import OUT_OF_TIME
from hybridid.trace.trials import tried
from hybridid.trace.trials.trial import PASSED
from hybridid.trace.verdict import conclude

DF_V = 75.0
TRIED = tuple(map(effect_named, ("coulomb", "offset", "asymmetric_viscous")))
OVER = time.monotonic()
"""A time that is over."""


@pytest.fixture(scope="module")
def context(split_of):
    """A search that has no time left when it begins."""
    return Context(split_of(df_v=DF_V), TRIED, variables=("velocity",), until=OVER)


@pytest.fixture(scope="module")
def ended(make_model, context):
    """What that search found from a model that lacks two effects."""
    return conclude(make_model(("viscous", "offset")), context)


def test_the_first_step_is_ended_and_no_other_begins(ended):
    assert [one.name for one in ended.accepted] == ["carriage.coulomb"]
    assert ended.search.stopped == OUT_OF_TIME
    assert ended.out_of_time


def test_what_was_accepted_is_open_while_far_more_than_noise_is_left(make_model, context, ended):
    assert ended.verdict == "undecided"
    generous = replace(context, rules=replace(context.rules, far=1e6))
    assert conclude(make_model(("viscous", "offset")), generous).verdict == "effect_found"


@pytest.fixture(scope="module")
def many(context):
    """Seven effects, of which the declared model lacks six; five are tried in any time."""
    more = ("lugre", "quadratic_drag", "stribeck", "linear_stiffness")
    return replace(context, effects=(*map(effect_named, more), *TRIED))


@pytest.fixture(scope="module")
def cut(make_model, many):
    """What a search found that could try five of six effects."""
    return conclude(make_model(("viscous", "offset")), many)


def test_the_quickest_and_most_promising_effects_are_tried_first(cut):
    (step,) = cut.search.steps
    assert len(step.trials) == tried.ALWAYS
    assert step.left_out == ("carriage.lugre",)
    assert cut.out_of_time


def test_a_step_that_left_out_an_effect_gives_no_name(cut):
    passed = [one.candidate.name for one in cut.search.steps[-1].trials if one.status == PASSED]
    assert "carriage.coulomb" in passed
    assert cut.accepted == ()
    assert cut.verdict == "undecided"
    assert cut.ceilings == ()


def test_no_step_begins_that_would_end_too_late(make_model, context, monkeypatch):
    hours = count(step=3600.0)
    monkeypatch.setattr(search, "time", SimpleNamespace(monotonic=lambda: next(hours)))
    found = conclude(make_model(("viscous", "offset")), replace(context, until=time.monotonic() + 1800.0))
    assert [one.name for one in found.accepted] == ["carriage.coulomb"]
    assert found.search.stopped == OUT_OF_TIME
    assert [step.family for step in found.search.steps] == [0]
    assert found.out_of_time


def test_no_pairs_and_no_laws_are_tried(make_model, context):
    nothing_helps = replace(context, effects=(effect_named("input_gain"),))
    found = conclude(make_model(), nothing_helps)
    assert found.out_of_time
    assert [step.family for step in found.search.steps] == [0]


def test_what_is_complete_when_the_time_ends_is_not_cut_short(make_model, context):
    found = conclude(make_model(), context)
    assert found.search.at_noise
    assert not found.out_of_time


def test_a_revision_that_was_asked_for_is_left_out(make_model, context):
    found = conclude(make_model(), replace(context, revise=True))
    assert found.out_of_time
    assert found.unrevised
    assert found.replacements == ()


def test_the_sentence_begins_with_the_limit(make_model, split_of):
    split = split_of(df_v=DF_V)
    first, second = split.records
    asked = {"effects": TRIED, "variables": ("velocity",)}
    found = trace(make_model(("viscous", "offset")), [first], [second], time_limit=1e-3, **asked)
    assert found.time_limit == 1e-3
    assert found.sentence.startswith(
        "The time limit of 0.001 s ended the search after 1 step: the verdict holds for what was tried by "
        "then. A larger trace.time_limit goes on from there. The best so far: coulomb at carriage"
    )
    assert found.verdict == "undecided"
    assert found.sentence.endswith(
        "The search for the rest was cut off. It may put another effect in its place."
    )
    asked["effects"] = TRIED[2:]
    assert trace(make_model(), [first], [second], time_limit=1e3, **asked).time_limit is None


def test_the_sentence_tells_what_is_left_out_and_the_best_so_far(make_model, split_of, many):
    first, second = split_of(df_v=DF_V).records
    asked = {"effects": many.effects, "variables": ("velocity",)}
    found = trace(make_model(("viscous", "offset")), [first], [second], time_limit=1e-3, **asked)
    said = found.sentence.replace("\N{NO-BREAK SPACE}", " ")
    assert "ended the search in step 1 and left 1 of 6 effects untried: the verdict holds for" in said
    assert "The best so far: stribeck at carriage (df_s = " in said
    assert "which is no name while others are untried, on held-out horizons of 0.4 s (" in said
    assert "The error left without it is " in said
    assert len(found.steps[0].left_out) == 1
