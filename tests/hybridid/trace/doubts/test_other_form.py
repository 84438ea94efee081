"""A name whose form another function of the same variable outdoes is withdrawn (simulated)."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.effects.composed import form_over, law
from hybridid.effects.library import effect_named
from hybridid.effects.over import BRISTLE, Over
from hybridid.trace.context import Context
from hybridid.trace.doubts.other_form import _others, other_form
from hybridid.trace.doubts.stand_in import unless_another_form
from hybridid.trace.laws.laws import with_law
from hybridid.trace.learned.ceiling import ceiling
from hybridid.trace.refits.numerics import DECLARED
from hybridid.trace.search.search import search
from hybridid.trace.trials.trial import REJECTED

VISCOUS, DRAG = effect_named("viscous"), effect_named("quadratic_drag")
UNDAMPED = ("coulomb@carriage", "offset@carriage")


@pytest.fixture(scope="module")
def named(make_model, split_of):
    """``named(drag=900.0)``: a trace that knows viscous friction alone, of a carriage that is declared
    without any."""

    def make(effects=(VISCOUS,), **truth):
        context = Context(split_of(**truth), effects, laws=False)
        return search(make_model(UNDAMPED), context, [{}], DECLARED), context

    return make


@pytest.fixture(scope="module")
def of_another_form(named):
    return named(f_v=0.0, drag=900.0)


def test_the_nearest_law_of_the_library_is_no_name(of_another_form):
    found, context = of_another_form
    assert [one.name for one in found.accepted] == ["carriage.viscous"]
    kept = unless_another_form(found, context)
    assert kept.accepted == ()
    assert kept.final is found.first
    assert (
        "carriage.signed_square_of_velocity in its place, with no more parameters, leaves" in kept.withdrawn
    )
    (refused,) = kept.steps[0].trials
    assert refused.status == REJECTED


def test_the_laws_of_its_variable_are_tried_whatever_a_learned_effort_finds(of_another_form):
    """Bumps do not hold every kink: a learned effort that finds nothing leaves laws out otherwise."""
    found, context = of_another_form
    kept = unless_another_form(found, context)
    assert kept.other_laws == (("carriage", Over("velocity")),)
    learned = ceiling(kept.final, context.split, "carriage", Over("velocity"))
    blind = replace(learned, refit=kept.final, gain=0.0, p_value=1.0, beyond=False)
    assert with_law(replace(kept, other_laws=()), [blind], context).accepted == ()
    (law,) = with_law(kept, [blind], context).accepted
    assert law.name == "carriage.signed_square_of_velocity"


def test_a_true_form_keeps_its_name(named):
    found, context = named(f_v=203.0)
    assert [one.name for one in found.accepted] == ["carriage.viscous"]
    assert unless_another_form(found, context) is found


def test_friction_that_falls_by_another_law_is_not_called_stribeck_s(make_model, split_by_model):
    """Tustin's falls with exp(-|v|/s), the library's with exp(-(v/v_s)^2)."""
    tustin = law("tustin_of_velocity", k=8.0, s=0.02)
    true = {"M": 95.0, "carriage.viscous.f_v": 200.0, "carriage.coulomb.f_c": 20.0}
    split = split_by_model(make_model(("viscous", "coulomb", "offset", tustin)), true)
    context = Context(split, (effect_named("stribeck"),), laws=False)
    found = search(make_model(), context, [{}], DECLARED)
    assert [one.name for one in found.accepted] == ["carriage.stribeck"]
    said = unless_another_form(found, context).withdrawn
    assert "carriage.tustin_of_velocity in its place, with no more parameters, leaves" in said


def test_what_does_not_survive_other_numerics_refutes_no_name(of_another_form, monkeypatch):
    found, context = of_another_form
    monkeypatch.setattr("hybridid.trace.doubts.other_form.surviving", lambda *given: [])
    assert other_form(found, context) is None


def test_a_model_that_has_not_converged_refutes_no_name(of_another_form):
    found, context = of_another_form
    unfinished = replace(found, final=replace(found.final, converged=False))
    assert other_form(unfinished, context) is None


def test_shapes_are_asked_that_no_effect_has_and_that_have_no_more_parameters(of_another_form):
    found, context = of_another_form
    (one,) = found.accepted
    asked = [shape.name for shape in _others(one, context)]
    assert asked == ["modulus", "sign", "square", "signed_square", "cube"]
    knows_drag = replace(context, effects=(VISCOUS, DRAG))
    assert "signed_square" not in [shape.name for shape in _others(one, knows_drag)]


def test_one_of_a_class_claims_no_form(of_another_form):
    found, context = of_another_form
    (one,) = found.accepted
    assert _others(replace(one, alike=(one.trial, one.trial)), context) == []


@pytest.mark.parametrize(
    ("name", "over"),
    [
        ("eddy_brake", Over("velocity")),
        ("position_damping", Over("position", "velocity")),
        ("load_friction", Over("load", "sign of velocity")),
        ("dahl", Over(BRISTLE)),
        ("backlash", None),
        ("input_gain", None),
    ],
)
def test_the_variable_of_a_form(name, over):
    assert form_over(effect_named(name)) == over
