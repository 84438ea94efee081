"""On simulated carriages: a law keeps its amplitude from record to record."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.doubts.stand_in import unless_moved
from hybridid.trace.horizons.split import by_record
from hybridid.trace.refits.refit import refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.search import of_constant_amplitude, search
from hybridid.trace.trials.constancy import Amplitude, amplitudes, fitted_to_held_out, moved, told_of_held_out
from hybridid.trace.trials.judgement import judge
from hybridid.trace.trials.trial import PASSED, attempt

RULES, HORIZON = Rules(), 50
NAME = "carriage.asymmetric_viscous"
TRIED = (effect_named("asymmetric_viscous"),)


@pytest.fixture(scope="module")
def traced(two_records, make_model):
    """A search for an asymmetric friction of 80 N·s/m where it is fitted, and so much where it is judged."""

    def make(there: float, rules: Rules = RULES):
        (first, _), (_, second) = two_records(df_v=80.0), two_records(df_v=there)
        context = Context(by_record([first], [second], HORIZON), TRIED, rules)
        return search(make_model(), context, [{}]), context

    return make


def test_a_law_of_the_machine_keeps_its_amplitude(traced):
    found, context = traced(80.0)
    (there,) = fitted_to_held_out([found.final], context)
    (one,) = amplitudes(found.final, there, NAME)
    assert one.name == "df_v"
    assert one.here[0] == pytest.approx(80.0, rel=0.05)
    assert one.there[0] == pytest.approx(80.0, rel=0.05)
    assert moved(found.final, there, NAME, RULES) == ""
    assert (
        unless_moved(replace(found, stopped="no further effect passes"), context).accepted == found.accepted
    )


def test_what_is_told_of_the_held_out_records_counts_the_smoothing(traced):
    found, context = traced(80.0)
    (there,) = fitted_to_held_out([found.final], context)
    told = told_of_held_out(found.final, context)
    assert told.values == there.values
    assert told.std.keys() == there.std.keys()
    assert all(told.std[name] >= 0.999 * there.std[name] for name in there.std)
    assert told.std["carriage.coulomb.f_c"] > 1.05 * there.std["carriage.coulomb.f_c"]


def test_a_name_with_another_amplitude_in_the_held_out_records_is_withdrawn(traced):
    found, context = traced(50.0, Rules(alpha=0.5))
    assert [one.name for one in found.accepted] == [NAME]
    found = replace(found, stopped="no further effect passes")
    kept = unless_moved(found, context)
    assert kept.accepted == ()
    assert kept.final is found.first
    assert "its amplitude is no constant: df_v = 79." in kept.withdrawn
    assert "N·s/m in the fitted records, " in kept.withdrawn


def test_at_the_noise_nothing_is_left_to_doubt(traced):
    found, context = traced(50.0, Rules(alpha=0.5))
    at_noise = replace(found, stopped="the residual meets the noise floor")
    assert unless_moved(at_noise, context) is at_noise


@pytest.mark.parametrize(
    ("here", "there", "size", "said"),
    [
        ((1.0, 0.01), (1.4, 0.01), 1.0, False),  # significant, and less than half
        ((1.0, 0.5), (2.0, 0.5), 1.0, False),  # large, and no more than chance
        ((1.0, 0.1), (2.0, 0.1), 1.0, True),
        ((1.0, 0.1), (-1.0, 0.1), 1.0, True),
        ((0.01, 0.001), (0.1, 0.001), 5.0, False),  # small beside another amplitude of the effect
        ((1.0, math.nan), (9.0, 0.1), 1.0, False),  # unknown
        ((1.0, 0.1), (0.0, math.nan), 0.0, True),  # nothing there, at its bound
        ((1.0, 0.5), (0.0, math.nan), 0.0, False),
    ],
)
def test_it_must_matter_and_be_no_chance(monkeypatch, here, there, size, said):
    one = Amplitude("f_c", "N", here, there, size)
    monkeypatch.setattr("hybridid.trace.trials.constancy.amplitudes", lambda *_: (one,))
    fitted, stopped = SimpleNamespace(converged=True), SimpleNamespace(converged=False)
    assert bool(moved(fitted, fitted, "motor.coulomb", RULES)) is said
    assert moved(stopped, fitted, "motor.coulomb", RULES) == ""
    assert moved(fitted, stopped, "motor.coulomb", RULES) == ""


def test_what_cannot_be_fitted_there_says_nothing():
    assert moved(None, None, "motor.coulomb", RULES) == ""


def test_a_chance_difference_is_rare():
    """Of 2000 names whose amplitude is constant, at most 2 % are called moved (alpha is 1 %)."""
    rng = np.random.default_rng(3)
    pairs = [Amplitude("f_c", "N", (a, 1.0), (b, 1.0), 0.1) for a, b in rng.normal(1.0, 1.0, (2000, 2))]
    assert 0 < sum(one.p_value <= RULES.alpha for one in pairs) <= 40


def test_of_a_class_the_members_that_move_are_refused(make_model, split_of, monkeypatch):
    split, names = split_of(df_v=80.0), ("asymmetric_viscous", "asymmetric_coulomb")
    context, base = Context(split, TRIED), refit(make_model(), split)
    first, second = judge(
        [attempt(Candidate(effect_named(name), "carriage"), base, split) for name in names], RULES
    )
    assert first.status == second.status == PASSED
    assert of_constant_amplitude((first,), context) == ((first,), {}), "one alone is judged in the last model"
    assert of_constant_amplitude((first, second), context)[1].keys() <= {second.candidate.name}
    moves = {first.candidate.name}
    monkeypatch.setattr(
        "hybridid.trace.search.search.moved", lambda here, there, name, rules: "m" * (name in moves)
    )
    kept, refused = of_constant_amplitude((first, second), context)
    assert kept == (second,)
    assert [(one.status, one.reason) for one in refused.values()] == [("rejected", "m")]
    moves.add(second.candidate.name)
    assert of_constant_amplitude((first, second), context) == ((first, second), {}), (
        "none is better than another"
    )
