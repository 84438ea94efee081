"""On simulated carriages: a law whose amplitude follows another variable is proposed with its level."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.effects.composed import ComposedLaw
from hybridid.effects.levels import Level
from hybridid.effects.library import effect_named
from hybridid.effects.over import Over
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.laws.law_levels import try_level, with_levels
from hybridid.trace.laws.laws import family_of
from hybridid.trace.laws.level_starts import level_starts
from hybridid.trace.learned.varying import vary
from hybridid.trace.refits.refit import refit
from hybridid.trace.trials.trial import attempt
from hybridid.trace.verdict import conclude

STIFFNESS, FADE = 800.0, 2.0
TRIED = tuple(map(effect_named, ("stribeck", "input_gain")))


@pytest.fixture(scope="module")
def said():
    return []


@pytest.fixture(scope="module")
def context(split_of, said):
    """A spring whose stiffness fades with the time."""
    split = split_of(stiffness=STIFFNESS, fade=FADE)
    return Context(split, TRIED, say=said.append, variables=("position", "time"))


@pytest.fixture(scope="module")
def proposed(make_model, context):
    return conclude(make_model(), context)


def test_the_level_is_proposed_with_its_numbers(proposed):
    assert proposed.verdict == "law_proposed"
    (one,) = proposed.accepted
    law = one.trial.candidate.effect.law
    assert isinstance(law, ComposedLaw)
    assert (law.name, law.level) == ("proportional", Level(Over("time"), "fading"))
    values = one.trial.own("values")
    assert values["k"] == pytest.approx(STIFFNESS, rel=0.01)
    assert values["s_2"] == pytest.approx(FADE, rel=0.01)
    assert proposed.search.final.score.rmse == pytest.approx(2e-6, rel=0.1)


def test_every_product_counts(proposed, said):
    """Bonferroni over the laws of one variable, and all of them with every level."""
    (line,) = (line for line in said if "laws" in line)
    family = int(line.split()[1])
    assert family > 5 * family_of(proposed.ceilings)
    (one,) = proposed.accepted
    assert one.trial.p_adjusted == pytest.approx(min(1.0, family * one.trial.comparison.p_value))


def test_it_is_drawn_over_the_freed_amplitude(proposed):
    drawn = proposed.accepted[0].drawn
    assert (drawn.value, str(drawn.over), drawn.unit, drawn.over_unit) == ("amplitude", "time", "1", "s")
    fall = drawn.curve.value[-1] / drawn.curve.value[0]
    seconds = drawn.curve.at[-1] - drawn.curve.at[0]
    assert fall == pytest.approx(np.exp(-seconds / FADE), rel=0.05)
    assert drawn.learned.value == pytest.approx(drawn.curve.value, abs=0.1 * drawn.curve.value[0])


def test_a_level_starts_in_the_likeness_of_the_freed_amplitude(proposed, context):
    base, split, level = proposed.search.first, context.split, Level(Over("time"), "fading")
    alone = attempt(Candidate(effect_named("proportional_of_position"), "carriage"), base, split)
    freed = vary(alone.refit, split, alone.candidate.name, level.over, 0.0)
    begun = level_starts(alone.candidate, level, freed, split)
    assert begun["k"].guess == pytest.approx(STIFFNESS, rel=0.2)
    assert begun["s_2"].guess == pytest.approx(FADE, rel=0.5)
    trial = try_level(alone.candidate, level, freed, base, split)
    assert trial.refit.score.loss == pytest.approx(proposed.search.final.score.loss, rel=0.01)


def test_no_level_is_sought_where_a_law_of_one_variable_reaches_the_noise(make_model, split_of):
    context = Context(split_of(stiffness=STIFFNESS), TRIED, variables=("position", "time"))
    base = refit(make_model(), context.split)
    law = attempt(Candidate(effect_named("proportional_of_position"), "carriage"), base, context.split)
    assert law.refit.score.rmse == pytest.approx(2e-6, rel=0.1)
    assert with_levels(base, [law], (), context) == ([], 0)
