"""Simulated carriages whose declared friction is not the true one: what replaces it is told."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.refits.numerics import DECLARED
from hybridid.trace.refits.refit import CONTINUATION, refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.revision import _without, replacements
from hybridid.trace.search.search import continued
from hybridid.trace.search.steps import AT_FLOOR, Search, Step

TRUE = tuple(map(effect_named, ("coulomb", "quadratic_drag")))
WRONG = ("viscous", "offset")


@pytest.fixture
def stalled(make_model, split_of):
    """``stalled(declared, f_v=0, ...)``: a search that added nothing, and its horizons."""

    def make(declared=WRONG, **truth):
        model, split = make_model(declared), split_of(**truth)
        base = refit(model, split, [{}], None, DECLARED, CONTINUATION)
        return model, Search((), base, (), "no further effect passes"), split

    return make


@pytest.fixture
def mended(stalled):
    """``mended(more, ...)``: a search that has come to a model with the effects ``more``."""

    def make(more, declared=WRONG, **truth):
        model, found, split = stalled(declared, **truth)
        richer = model
        for name in more:
            richer = richer.plus(effect_named(name))
        last = refit(richer, split, [found.final.values], found.final, DECLARED, CONTINUATION)
        return model, replace(found, steps=(Step(found.final, (), None),), final=last), split

    return make


def test_the_pair_that_does_better_replaces_the_declared_effect(stalled):
    said = []
    model, found, split = stalled(f_v=0.0, drag=900.0)
    (best,) = replacements(model, found, Context(split, TRUE, say=said.append))
    assert (best.left_out, best.kind, best.fewer) == ("carriage.viscous", "better", -1)
    assert {one.name for one in best.accepted} == {"carriage.coulomb", "carriage.quadratic_drag"}
    assert best.refit.values["carriage.quadratic_drag.c_d"] == pytest.approx(900.0, rel=0.05)
    assert best.refit.values["carriage.coulomb.f_c"] == pytest.approx(20.4, rel=0.02)
    assert "carriage.viscous.f_v" not in best.refit.values
    assert best.gain > 0.5
    assert [line for line in said if line.startswith("without")] == [
        "without carriage.viscous: the search is repeated",
        "without carriage.offset: the search is repeated",
    ]


def test_as_good_with_fewer_parameters_replaces_the_declared_effect(mended):
    """The search has mended the viscous friction with more effects than the truth has."""
    model, found, split = mended(("coulomb", "quadratic_drag", "eddy_brake"), f_v=0.0, drag=900.0)
    (best,) = replacements(model, found, Context(split, TRUE))
    assert (best.left_out, best.kind, best.fewer) == ("carriage.viscous", "as_good", 3)
    assert {one.name for one in best.accepted} == {"carriage.coulomb", "carriage.quadratic_drag"}
    assert abs(best.gain) < Rules().tie


def test_what_was_accepted_may_do_without_the_declared_effect(stalled):
    """Nothing else is tried, so only the accepted effects can stand in its place."""
    model, begun, split = stalled(f_v=0.0, drag=900.0)
    found = continued(begun, Context(split, TRUE))
    found = replace(found, steps=(Step(begun.final, (), None), *found.steps))
    assert {one.name for one in found.accepted} == {"carriage.coulomb", "carriage.quadratic_drag"}
    (best,) = replacements(model, found, Context(split, ()))
    assert (best.left_out, best.kind, best.fewer) == ("carriage.viscous", "as_good", 1)
    assert best.accepted == found.accepted


def test_no_replacement_of_what_is_true(stalled):
    declared = ("viscous", "coulomb", "offset")
    model, found, split = stalled(declared)
    assert replacements(model, found, Context(split, (effect_named("quadratic_drag"),))) == ()


def test_at_the_noise_only_an_effect_of_several_parameters_is_left_out(stalled):
    """What takes the place of one parameter has one at least, and explains no more than all."""
    said = []
    model, found, split = stalled(("viscous", "stribeck"))
    ended = replace(found, stopped=AT_FLOOR)
    replacements(model, ended, Context(split, (effect_named("offset"),), say=said.append))
    left_out = [line for line in said if line.startswith("without")]
    assert left_out == ["without carriage.stribeck: the search is repeated"]


def test_a_sound_effect_stays_where_a_new_one_only_stands_for_it(stalled):
    """Coulomb friction is missing. Without the viscous friction, which is true, it is found, and an eddy
    brake that is viscous at these velocities; beside that, viscous friction explains nothing more."""
    model, found, split = stalled()
    library = tuple(map(effect_named, ("coulomb", "eddy_brake")))
    again = _without(model.terms[0], found, Context(split, library))
    assert [one.name for one in again.accepted] == ["carriage.eddy_brake", "carriage.coulomb"]
    assert replacements(model, found, Context(split, library)) == ()


def test_a_sound_declaration_stays_though_the_search_added_too_much(mended):
    """Drag and a cubic spring are needless. Without the viscous friction, two effects explain nearly as much
    as all five do."""
    model, found, split = mended(("coulomb", "quadratic_drag", "cubic_stiffness"))
    library = tuple(map(effect_named, ("coulomb", "eddy_brake")))
    assert replacements(model, found, Context(split, library)) == ()


def test_at_the_noise_only_models_with_fewer_parameters_are_tried(mended):
    """Nothing better can be found there, so only what is as good with fewer parameters may replace."""
    model, found, split = mended(("coulomb", "quadratic_drag"), f_v=0.0, drag=900.0)
    library = tuple(map(effect_named, ("coulomb", "quadratic_drag", "eddy_brake", "lugre")))
    anywhere, ended = (
        _without(model.terms[0], search, Context(split, library))
        for search in (found, replace(found, stopped=AT_FLOOR))
    )
    assert len(anywhere.steps[0].trials) == 4
    tried = [(step.base.model.free, trial.candidate) for step in ended.steps for trial in step.trials]
    assert {len(free) + one.free_parameters for free, one in tried} <= set(range(len(found.final.model.free)))
    assert {one.effect.id for _, one in tried} == {"coulomb", "quadratic_drag", "eddy_brake"}
    assert {one.name for one in ended.accepted} == {"carriage.coulomb", "carriage.quadratic_drag"}
