"""Simulated carriages whose declared friction is not the true one: what replaces it is told."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.numerics import DECLARED
from hybridid.trace.refit import CONTINUATION, refit
from hybridid.trace.revision import idle_terms, replacements
from hybridid.trace.search import Search

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


def test_the_pair_that_does_better_replaces_the_declared_effect(stalled):
    said = []
    model, found, split = stalled(f_v=0.0, drag=900.0)
    (best,) = replacements(model, found, Context(split, TRUE, say=said.append))
    assert best.left_out == "carriage.viscous"
    assert {one.name for one in best.accepted} == {"carriage.coulomb", "carriage.quadratic_drag"}
    assert best.refit.values["carriage.quadratic_drag.c_d"] == pytest.approx(900.0, rel=0.05)
    assert best.refit.values["carriage.coulomb.f_c"] == pytest.approx(20.4, rel=0.02)
    assert "carriage.viscous.f_v" not in best.refit.values
    assert best.gain > 0.5
    assert [line for line in said if line.startswith("without")] == [
        "without carriage.viscous: the search is repeated",
        "without carriage.offset: the search is repeated",
    ]


def test_no_replacement_of_what_is_true(stalled):
    declared = ("viscous", "coulomb", "offset")
    model, found, split = stalled(declared)
    assert replacements(model, found, Context(split, (effect_named("quadratic_drag"),))) == ()


def test_declared_effects_that_end_at_zero_are_told(make_model):
    def estimate(**values):
        named = {"carriage.viscous.f_v": (200.0, 3.0), "carriage.offset.offset": (-0.3, 0.25)} | values
        parameters = [SimpleNamespace(name=name, value=v, std=std) for name, (v, std) in named.items()]
        return SimpleNamespace(parameters=parameters)

    model = make_model(("viscous", "offset"))
    assert idle_terms(model, estimate()) == ("carriage.offset",)
    assert idle_terms(model, estimate(**{"carriage.offset.offset": (-3.2, 0.25)})) == ()
    nothing = {"carriage.viscous.f_v": (0.0, float("nan"))}
    assert idle_terms(model, estimate(**nothing)) == ("carriage.offset",)
