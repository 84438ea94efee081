"""On a simulated carriage: a declared effect is doubted if structure remains over its own variable."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.effects.over import Over
from hybridid.trace.candidates import Candidate
from hybridid.trace.cautions.doubted import (
    doubted,
    in_doubt,
    one_curve,
    other_law_possible,
    refuted_form,
    revision_advised,
    simpler_possible,
)
from hybridid.trace.context import Context
from hybridid.trace.learned.ceiling import ceiling
from hybridid.trace.refits.refit import refit


@pytest.fixture(scope="module")
def fitted(make_model, split_of):
    """The symmetric model of a carriage whose friction differs by direction."""
    split = split_of(df_v=80.0)
    return refit(make_model(), split), split


@pytest.mark.parametrize(
    ("over", "names"),
    [
        (Over("velocity"), ["carriage.viscous", "carriage.coulomb"]),  # an offset is no function of it
        (Over("position", "velocity"), ["carriage.viscous"]),
        (Over("position"), []),
    ],
)
def test_functions_of_the_variable_are_doubted(fitted, over, names):
    base, split = fitted
    found = ceiling(base, split, "carriage", over)
    assert doubted(base.model, base, [found], split) == names


def ended_with(fitted, effect, remains=True, times=1.0):
    """As if the ``effect`` had been found, and structure ``remains`` over the velocity; with its context."""
    base, split = fitted
    found = ceiling(base, split, "carriage", Over("velocity"))
    candidate = Candidate(effect_named(effect), "carriage")
    accepted = SimpleNamespace(name=candidate.name, trial=SimpleNamespace(candidate=candidate))
    ended = SimpleNamespace(
        verdict="effect_found", accepted=(accepted,), search=SimpleNamespace(final=base), ceilings=[found],
        remains=(f"at {found.place}",) if remains else (), times=times,
    )  # fmt: skip
    return ended, Context(split, ())


@pytest.mark.parametrize(
    ("effect", "remains", "said"),
    [
        (
            "viscous",
            True,
            " carriage.viscous is itself a function of a variable over which structure remains",
        ),
        ("viscous", False, ""),
        ("offset", True, ""),
    ],
)
def test_an_accepted_effect_is_doubted_in_the_same_way(fitted, effect, remains, said):
    """As if the carriage's friction had been found."""
    ended, context = ended_with(fitted, effect, remains)
    told = other_law_possible(ended, context)
    ended.verdict = "undecided"
    assert other_law_possible(ended, context) == "", "the rest may explain it"
    assert told.startswith(said)
    assert bool(told) is bool(said)


@pytest.mark.parametrize(
    ("times", "effect", "refuted"), [(9.0, "viscous", True), (2.0, "viscous", False), (9.0, "offset", False)]
)
def test_a_curve_that_takes_most_of_what_is_left_refutes_the_form(fitted, times, effect, refuted):
    """Friction that differs by direction is a function of the velocity, and viscous friction another one."""
    ended, context = ended_with(fitted, effect, times=times)
    assert refuted_form(ended, context) == ([f"carriage.{effect}"] if refuted else [])
    assert ("another law over it is there" in other_law_possible(ended, context)) is refuted


def test_it_is_told_where_nothing_explains_the_errors_and_a_revision_was_not_asked(fitted):
    base, split = fitted
    found = ceiling(base, split, "carriage", Over("velocity"))

    def told(verdict="unexplained", remains=(f"at {found.place}",), unrevised=False, better=(), **asked):
        search = SimpleNamespace(first=base, final=base)
        ended = SimpleNamespace(
            verdict=verdict, search=search, ceilings=[found], remains=remains, accepted=(),
            unrevised=unrevised, replacements=better,
        )  # fmt: skip
        return revision_advised(ended, Context(split, (), **asked))

    assert told() == (
        " What is declared over that variable (carriage.viscous and carriage.coulomb) may be the wrong law: "
        "trace.revise=true seeks others in its place."
    )
    assert (
        told(revise=True)
        == told("effect_found", revise=True)
        == (
            " trace.revise left out the declared carriage.viscous, carriage.coulomb and carriage.offset in "
            "turn: no other effects in the place of one explain more, or as much with fewer parameters."
        )
    )
    assert told(revise=True, better=("one",)) == told("law_proposed") == ""
    assert told("undecided", unrevised=True, revise=True) == (
        " The time limit left out trace.revise: no declared effect was questioned."
    )
    assert told(remains=()) == (
        " The declared carriage.viscous, carriage.coulomb and carriage.offset were not questioned: "
        "trace.revise=true seeks others in the place of each."
    )


@pytest.mark.parametrize(
    ("effect", "parameters", "revise", "told"),
    [
        ("stribeck", 2, False, True),
        ("stribeck", 2, True, False),  # it was asked
        ("asymmetric_viscous", 1, False, False),  # one parameter does not bend
        ("detent", 3, False, False),  # over the position, where nothing is declared
    ],
)
def test_a_flexible_effect_over_the_variable_of_a_declared_one_may_mend_a_wrong_law(
    fitted, effect, parameters, revise, told
):
    ended, context = ended_with(fitted, effect, remains=False)
    ended.search.first = ended.search.final
    ended.accepted[0].trial.free_parameters = parameters
    said = simpler_possible(ended, replace(context, revise=revise))
    both = f" carriage.{effect} and the declared carriage.viscous and carriage.coulomb are functions of one"
    assert said.startswith(both) is told
    assert bool(said) is told


@pytest.mark.parametrize(
    ("verdict", "effect", "instead", "doubt"),
    [
        ("effect_found", "viscous", {"carriage.viscous"}, True),
        ("effect_found", "viscous", set(), False),
        ("law_proposed", "modulus_of_velocity", {"carriage.modulus_of_velocity"}, True),
        ("law_proposed", "modulus_of_velocity", {"carriage.viscous"}, False),
        ("unexplained", "viscous", {"carriage.viscous"}, False),
    ],
)
def test_a_name_or_a_law_is_in_doubt_where_something_else_explains_as_much(
    fitted, verdict, effect, instead, doubt
):
    ended, context = ended_with(fitted, effect, remains=False)
    ended.verdict = verdict
    assert in_doubt(ended, instead, context) == doubt


@pytest.mark.parametrize(
    ("effects", "told"),
    [
        (("quadratic_drag", "stribeck"), True),
        (("stribeck", "asymmetric_viscous"), False),  # odd and even: the records tell them apart
        (("quadratic_drag", "viscous"), False),  # neither bends
        (("stribeck", "position_damping"), False),  # another variable
        (("position_damping", "cube_of_position_times_velocity"), True),  # a law beside a name
        (("position_damping", "exponential_rise_of_position_times_velocity"), True),  # odd and even in one
        (("quadratic_drag", "modulus_of_velocity"), False),  # odd and even again
        (("position_damping", "modulus_of_velocity"), False),
        (("proportional_of_position", "exponential_rise_of_position"), False),  # laws are no names
        (("stribeck", "detent"), False),
        (("stribeck",), False),
    ],
)
def test_two_functions_of_one_variable_are_parts_of_a_curve(make_model, split_of, effects, told):
    """A sum that may bend at will is no evidence for each of its parts."""
    split = split_of()
    base = refit(make_model(("offset",)), split)
    model, values, accepted = base.model, dict(base.values), []
    for effect in effects:
        candidate = Candidate(effect_named(effect), "carriage")
        model = candidate.added_to(model)
        values |= dict.fromkeys((p.name for p in model.free if p.name not in values), 1.0)
        trial = SimpleNamespace(candidate=candidate, free_parameters=candidate.free_parameters)
        accepted.append(SimpleNamespace(name=candidate.name, trial=trial))
    search = SimpleNamespace(final=replace(base, model=model, values=values))
    found = SimpleNamespace(accepted=accepted, search=search)
    names = " and ".join(f"carriage.{effect}" for effect in effects)
    said = one_curve(found, Context(split, ()))
    assert said.startswith(f" Beware: {names} are functions of one variable. ") is told
    assert bool(said) is told
