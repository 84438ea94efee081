"""Simulated carriages with a law that no effect tried has: the law is proposed, with its numbers."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.effects.over import Over
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import by_blocks
from hybridid.trace.laws.law_starts import law_starts
from hybridid.trace.laws.laws import _as_much_as_several, _unless_short, law_in_place, with_law
from hybridid.trace.learned.ceiling import ceiling
from hybridid.trace.refits.refit import refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.steps import Accepted, Search, Step
from hybridid.trace.trials.trial import PASSED, REJECTED, Trial, attempt
from hybridid.trace.verdict import conclude

DF_V = 80.0
TRIED = tuple(map(effect_named, ("stribeck", "input_gain")))
FEW = ("velocity", "position")


@pytest.fixture(scope="module")
def said():
    return []


@pytest.fixture(scope="module")
def proposed(make_model, split_of, said):
    """A trace of a carriage whose friction differs by direction, without the effect that names that."""
    return conclude(make_model(), Context(split_of(df_v=DF_V), TRIED, say=said.append))


def test_the_law_is_proposed_with_its_amplitude(proposed):
    assert proposed.verdict == "law_proposed"
    (one,) = proposed.accepted
    assert one.name == "carriage.modulus_of_velocity"
    assert one.trial.own("values")["k"] == pytest.approx(-DF_V / 2, rel=0.01)
    assert proposed.search.final.score.rmse == pytest.approx(2e-6, rel=0.1)
    assert proposed.remains == ()


def test_the_whole_family_counts(proposed, said):
    """Bonferroni over every law over every variable, whether it was tried or not."""
    (one,) = proposed.accepted
    (line,) = (line for line in said if "laws" in line)
    family = int(line.split()[1])
    assert family > 100
    assert one.trial.p_adjusted == pytest.approx(min(1.0, family * one.trial.comparison.p_value))


def test_it_is_drawn_over_the_learned_effort(proposed):
    drawn = proposed.accepted[0].drawn
    assert (drawn.port, str(drawn.over), drawn.unit, drawn.over_unit) == ("carriage", "velocity", "N", "m/s")
    learned = np.interp(drawn.curve.at, drawn.learned.at, drawn.learned.value)
    fast = abs(drawn.curve.at) > 0.02
    assert np.ptp(drawn.curve.value) > 2.0
    assert drawn.curve.value[fast] == pytest.approx(learned[fast], abs=0.5)
    k = proposed.accepted[0].trial.own("values")["k"]
    assert drawn.curve.value == pytest.approx(k * abs(drawn.curve.at), abs=abs(k) * 0.01)


def test_a_law_that_falls_short_of_the_learned_effort_over_its_variable_has_another_form(proposed, split_of):
    base, one = proposed.search.first, proposed.accepted[0].trial
    learned = ceiling(base, split_of(df_v=DF_V), "carriage", Over("velocity"))
    assert _unless_short(one, base, [learned], Rules()) is one
    part = one.refit.score
    worse = replace(
        part,
        squares=0.5 * base.score.squares,
        block_squares=0.5 * base.score.block_squares,
        likelihood=part.likelihood - 1.0,
    )
    short = replace(one, refit=replace(one.refit, score=worse), comparison=compare(base.score, worse))
    refused = _unless_short(short, base, [learned], Rules())
    assert refused.status == REJECTED
    assert refused.reason.startswith("another form: it takes 50% of the squared error, a learned effort at ")
    assert _unless_short(short, base, [], Rules()) is short


def test_a_law_starts_in_the_likeness_of_the_learned_effort(proposed, split_of):
    split, base = split_of(df_v=DF_V), proposed.search.first
    learned = ceiling(base, split, "carriage", Over("velocity"))
    shape = proposed.accepted[0].trial.candidate.effect.law.shape
    (amplitude,) = law_starts(learned, shape, base, split).values()
    assert amplitude.guess == pytest.approx(-DF_V / 2, rel=0.2)


def test_nothing_is_proposed_where_nothing_is_missing(make_model, split_of):
    context = Context(split_of(), TRIED, variables=FEW)
    found = conclude(make_model(), context)
    assert found.verdict == "nothing_missing"
    assert found.accepted == ()
    again = with_law(found.search, found.ceilings, context)
    assert (again.accepted, again.final) == ((), found.search.final)
    assert again.refused_laws
    assert all(law.status != PASSED for law in again.refused_laws)
    assert again.laws_formed > len(again.refused_laws)


def test_a_sine_finer_than_any_learned_effort_is_found(make_model, split_of):
    """Twelve bumps over the stroke cannot show a ripple of short pitch, so they do not decide."""
    found = conclude(make_model(), Context(split_of(ripple=4.0, pitch=0.009), TRIED, variables=FEW))
    assert found.verdict == "law_proposed"
    (one,) = found.accepted
    assert one.name == "carriage.sine_of_position"
    values = one.trial.own("values")
    assert np.hypot(values["k_s"], values["k_c"]) == pytest.approx(4.0, rel=0.05)
    assert abs(values["T"]) == pytest.approx(0.009, rel=0.01)


@pytest.fixture(scope="module")
def stopped(make_model, two_records):
    """The symmetric model, fitted to a carriage that runs against a stop, and a learned effort over the
    position that finds nothing, as if the stop were too hard for its grid."""
    split = by_blocks(two_records(wall=0.02, hardness=2e4)[:1], 50)
    base = refit(make_model(), split)
    blind = replace(ceiling(base, split, "carriage", Over("position")), gain=0.0, p_value=1.0, refit=base)
    return base, blind, Context(split, TRIED)


def test_a_contact_is_tried_whatever_a_learned_effort_finds(stopped):
    base, blind, context = stopped
    (one,) = with_law(Search((), base, (), ""), [blind], context).accepted
    assert one.name == "carriage.above_of_position"
    assert one.trial.own("values") == pytest.approx({"k": 2e4, "c": 0.02}, rel=0.02)


def test_in_the_place_of_names_that_do_better_than_any_learned_effort_finer_laws_are_tried(stopped):
    base, blind, context = stopped
    spring = attempt(Candidate(effect_named("cubic_stiffness"), "carriage"), base, context.split)
    accepted = Accepted(spring, (spring,), ())
    found = Search((Step(base, (spring,), accepted),), spring.refit, (accepted,), "")
    lawful = law_in_place(found, [blind], context)
    assert [one.name for one in lawful.accepted] == ["carriage.above_of_position"]
    tried = {t.candidate.effect.law.name for t in lawful.steps[-1].trials}
    assert tried == {"above", "below", "power_above", "power_below", "beyond_gap", "sine"}


@pytest.fixture(scope="module")
def in_place(proposed, split_of):
    """``in_place(final, names)``: the law in the place of ``names`` with which a search ended."""
    split, said = split_of(df_v=DF_V), []
    base, context = proposed.search.first, Context(split, TRIED, say=said.append)
    learned = ceiling(base, split, "carriage", Over("velocity"))

    def replaced(final, names):
        trials = [Trial(Candidate(effect_named(name), "carriage"), final, None) for name in names]
        accepted = tuple(Accepted(trial, (trial,), ()) for trial in trials)
        found = Search(tuple(Step(base, (), one) for one in accepted), final, accepted, "")
        return found, law_in_place(found, [learned], context), said

    return replaced


def test_a_law_takes_the_place_of_effects_that_together_explain_less(proposed, in_place, split_of):
    base = proposed.search.first
    model = base.model.plus(effect_named("asymmetric_coulomb"), "carriage")
    poorer = refit(model, split_of(df_v=DF_V), [base.values], base)
    found, lawful, said = in_place(poorer, ("asymmetric_coulomb", "maxwell"))
    assert [one.name for one in lawful.accepted] == ["carriage.modulus_of_velocity"]
    assert lawful.first is found.first
    assert lawful.in_place_of == ("carriage.asymmetric_coulomb", "carriage.maxwell")
    assert said[0] == "laws in place of carriage.asymmetric_coulomb and carriage.maxwell"


def test_one_effect_that_explains_as_much_stays(proposed, in_place):
    found, lawful, _ = in_place(proposed.search.final, ("asymmetric_viscous",))
    assert lawful is found


def test_a_law_that_explains_no_more_is_said_to_take_no_place(proposed, in_place, monkeypatch):
    monkeypatch.setattr("hybridid.trace.laws.laws.with_law", lambda *given, **more: proposed.search)
    found, lawful, said = in_place(proposed.search.final, ("asymmetric_viscous",))
    assert lawful is found
    assert (
        said[-1] == "the law does not explain more than carriage.asymmetric_viscous: no law takes that place"
    )


def test_several_effects_of_one_curve_give_way_to_a_law_with_fewer_parameters(proposed, in_place):
    """Both are functions of the velocity, and so is a law of one parameter that explains as much."""
    _, lawful, _ = in_place(proposed.search.final, ("asymmetric_viscous", "coulomb"))
    assert [one.name for one in lawful.accepted] == ["carriage.modulus_of_velocity"]


@pytest.mark.parametrize(
    ("learned", "effects", "whole"), [(0.89, 2, False), (0.91, 2, True), (0.91, 1, False)]
)
def test_effects_are_one_curve_where_a_learned_effort_takes_as_much_as_all(learned, effects, whole):
    """Up to a tenth, the resolution of its grid; ``learned`` is its share of what the effects take."""
    first, final = (SimpleNamespace(score=SimpleNamespace(loss=loss)) for loss in (1.0, 0.0))
    one = SimpleNamespace(taken=lambda base: learned * base.score.loss**2)
    found = SimpleNamespace(first=first, final=final, accepted=[SimpleNamespace()] * effects)
    assert _as_much_as_several(found, [one], Rules()) == ([one] if whole else [])
