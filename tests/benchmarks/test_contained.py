"""A load behind a play contains one behind a spring, and is fitted from there, too. Simulated.

Scenario 64 of series 1000 of the drawn league: 4 % of a backlash at a carriage. Unless it begins where its
contact resonates, the backlash ends in a wrong valley, and the resonance of its closed contact was named.
"""

from __future__ import annotations

import pytest

from benchmarks.drawn import amount
from benchmarks.drawn.draw import draw_of
from benchmarks.drawn.machines import case_of
from benchmarks.drawn.oracle import split_of
from hybridid.effects.library import EFFECTS, effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit
from hybridid.trace.rules import Rules
from hybridid.trace.trials.contained import begun_from_contained, contains, is_the_contained_one
from hybridid.trace.trials.trial import Trial, attempt

DRAW = draw_of(10_000_064)
EFFECT_NAMES = ("backlash", "flexible_mode", "linear_stiffness")


@pytest.fixture(scope="module")
def trials():
    assert DRAW.key.endswith("carriage.backlash/4%/noise8.6e-05/switching")
    context = Context(split_of(case_of(DRAW), amount.records_of(DRAW)), EFFECTS, Rules())
    base = refit(case_of(DRAW).model(), context.split)
    candidates = [Candidate(effect_named(name), "carriage") for name in EFFECT_NAMES]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hybridid.trace.starts.sought.GRIDS", ("period", "place"))
        play = attempt(candidates[0], base, context.split)
    others = [attempt(candidate, base, context.split) for candidate in candidates[1:]]
    return context, base, [play, *others]


def test_what_contains_another_explains_at_least_as_much(trials):
    context, base, found = trials
    play, mode, spring = found
    assert play.refit.cost > 2 * mode.refit.cost, "its own starts find it: this test shows nothing"
    again, *same = begun_from_contained(found, base, context, "step 1")
    assert again.refit.cost < mode.refit.cost
    assert again.refit.score.rmse == pytest.approx(DRAW.noise, rel=0.05)
    assert again.own("values")["m_l"] == pytest.approx(2.2, rel=0.05), "kg, as it was drawn"
    assert is_the_contained_one(again, [again, mode]), "its play explains 1 % more: no valley of its own"
    assert not is_the_contained_one(again, [again, spring])
    assert same[0] is mode
    assert same[1] is spring


def test_what_cannot_be_chosen_lends_nothing(trials):
    context, base, (play, mode, _) = trials
    (kept,) = begun_from_contained([play], base, context, "step 1")
    assert kept is play
    refused = begun_from_contained([play, mode], mode.refit, context, "step 1")
    assert refused[0] is play, "the resonance takes nothing more beside itself"


@pytest.mark.parametrize(
    ("richer", "poorer", "so"),
    [
        ("backlash", "flexible_mode", True), ("flexible_mode", "backlash", False), ("bouc_wen", "dahl", True),
        ("dahl", "coulomb", True), ("preloaded_spring", "linear_stiffness", True),
        ("quadratic_drag", "offset", False), ("stribeck", "viscous", False),
    ],
)  # fmt: skip
def test_a_law_contains_a_look_alike_with_a_part_of_its_parameters(richer, poorer, so):
    one, other = (Trial(Candidate(effect_named(name), "joint"), None, None) for name in (richer, poorer))
    assert contains(one, other) is so
    elsewhere = Trial(Candidate(effect_named(poorer), "motor"), None, None)
    assert not contains(one, elsewhere)
