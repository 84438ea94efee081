"""A smoothing of sign(v) that leaves an error is made narrower before anything is named."""

from dataclasses import replace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.refit import refit
from hybridid.trace.search import search
from hybridid.trace.sharper import narrowed, sharp_enough


@pytest.fixture(scope="module")
def split(split_of):
    return split_of()


def smoothed(model, **setting):
    return replace(model, adjustments={**model.adjustments, "carriage.epsilon": setting})


def width_of(model):
    return next(p.guess for p in model.parameters if p.name == "carriage.epsilon")


def test_too_wide_a_smoothing_is_halved_until_that_gains_nothing(make_model, split):
    """The truth creeps as tanh(v/epsilon) does, epsilon that of the port."""
    model = make_model()
    true = width_of(model)
    wide = refit(smoothed(model, guess=8 * true), split)
    said = []
    found = sharp_enough(wide, Context(split, say=said.append))
    assert true <= width_of(found.model) <= 2 * true
    assert found.score.loss < 0.7 * wide.score.loss
    assert found.std
    assert len(said) == pytest.approx(3, abs=1)
    (told,) = narrowed(wide.model, found.model)
    assert (told.name, told.declared, told.used) == ("carriage.epsilon", 8 * true, width_of(found.model))


def test_a_smoothing_that_leaves_nothing_stays(make_model, split):
    base = refit(make_model(), split)
    assert sharp_enough(base, Context(split)) is base
    assert narrowed(base.model, base.model) == ()


def test_an_epsilon_that_the_user_fixed_stays(make_model, split):
    model = make_model()
    fixed = refit(smoothed(model, fixed=8 * width_of(model)), split)
    assert sharp_enough(fixed, Context(split)) is fixed


def test_a_smoothing_that_pays_only_beside_an_effect_begins_the_search_anew(make_model, split_of):
    """While the asymmetry is missing, the error of the smoothing is a small part of the whole."""
    said = []
    tried = tuple(map(effect_named, ("asymmetric_viscous", "quadratic_drag")))
    context = Context(split_of(df_v=75.0), tried, say=said.append)
    wide = smoothed(make_model(), guess=4 * width_of(make_model()))
    found = search(wide, context, [{}])
    assert [one.name for one in found.accepted] == ["carriage.asymmetric_viscous"]
    assert any("begins anew" in line for line in said)
    assert width_of(found.first.model) == width_of(found.final.model) < width_of(wide)
    assert [step.accepted.name for step in found.steps if step.accepted] == ["carriage.asymmetric_viscous"]
