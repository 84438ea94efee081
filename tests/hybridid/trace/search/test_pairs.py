"""A simulated carriage on a spring about a centre other than zero: spring and offset help only together."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.doubts.stand_in import unless_minor
from hybridid.trace.refits.refit import refit
from hybridid.trace.rules import Rules
from hybridid.trace.search import pair_decision
from hybridid.trace.search.pairs import in_place, with_pair
from hybridid.trace.search.search import search
from hybridid.trace.trials.cross_fitting import FEW, pairs_cross_fitted
from hybridid.trace.trials.pair import decided_pair
from hybridid.trace.trials.promise import promises
from hybridid.trace.trials.sensitivity import seen
from hybridid.trace.trials.trial import PASSED, REJECTED

STIFFNESS, CENTRE = 400.0, 0.15
DECLARED = ("viscous", "coulomb")
TRIED = tuple(map(effect_named, ("linear_stiffness", "asymmetric_viscous", "offset", "input_saturation")))
SPRING, OFFSET = "carriage.linear_stiffness", "carriage.offset"


@pytest.fixture(scope="module")
def said():
    return []


@pytest.fixture(scope="module")
def context(split_of, said):
    split = split_of(n=500, stiffness=STIFFNESS, centre=CENTRE, offset=0.0)
    return Context(split, TRIED, say=said.append)


@pytest.fixture(scope="module")
def stalled(make_model, context):
    return search(make_model(DECLARED), context, [{}])


@pytest.fixture(scope="module")
def paired(stalled, context):
    return with_pair(stalled, context)


def test_the_pair_is_found_where_neither_passes_alone(stalled, paired, said):
    assert stalled.accepted == ()
    assert {one.name: one.together for one in paired.accepted} == {SPRING: OFFSET, OFFSET: SPRING}
    values = paired.final.values
    assert values[f"{SPRING}.k"] == pytest.approx(STIFFNESS, rel=0.02)
    assert values[f"{OFFSET}.offset"] == pytest.approx(-STIFFNESS * CENTRE, rel=0.02)
    assert paired.final.score.rmse == pytest.approx(2e-6, rel=0.1)
    assert said[-1].startswith(f"of 6 pairs, 2 tried: {SPRING} and {OFFSET} take 9")


def test_it_completes_the_step_that_stalled(stalled, paired):
    (before,), (step,) = stalled.steps, paired.steps
    assert step.trials == before.trials
    assert [one.name for one in step.taken] == [SPRING, OFFSET]
    assert step.family == len(TRIED) * (len(TRIED) - 1) // 2
    (best,) = (pair for pair in step.pairs if pair.status == "passed")
    assert best.p_adjusted == pytest.approx(step.family * best.p_value)
    assert all(one.trial.gain > 0.9 for one in step.taken)
    assert all(one.alike == (one.trial,) for one in step.taken)
    assert all(len(one.survivals) > 3 for one in step.taken)


def test_a_pair_that_few_horizons_leave_open_both_sides_decide(stalled, paired, context):
    (step,) = paired.steps
    (best,) = (pair for pair in step.pairs if pair.status == PASSED)
    assert len(context.split.held_out) < FEW
    left_open = decided_pair(best, 0.02, context.rules)
    assert left_open.status == REJECTED
    (decided,) = pairs_cross_fitted([left_open], stalled.final, step.family, context)
    assert decided.status == PASSED
    assert decided.p_adjusted < 1e-3
    assert all(member.p_adjusted == decided.p_adjusted for member in decided.members)


def test_a_pair_of_which_one_is_not_worth_having_is_not_asked_again(stalled, paired, context):
    (step,) = paired.steps
    (best,) = (pair for pair in step.pairs if pair.status == PASSED)
    first, second = best.members
    little = replace(first, comparison=replace(first.comparison, gain=0.03))
    left_open = decided_pair(replace(best, members=(little, second)), 0.02, context.rules)
    assert pairs_cross_fitted([left_open], stalled.final, step.family, context) == [left_open]


def test_one_pair_is_refitted_where_one_is_asked_for_and_it_is_the_most_promising(stalled, context):
    found = with_pair(stalled, replace(context, pairs=1, rules=Rules(alpha=1e-15)))
    (tried,) = found.steps[-1].pairs
    assert {one.name for one in tried.candidates} == {SPRING, OFFSET}
    assert tried.status == REJECTED
    assert tried.reason.startswith("not significant")
    assert found.accepted == ()
    assert with_pair(found, context) is found  # the pairs of a step are tried once


def test_no_pair_is_tried_where_none_is_asked_for_or_may_be_accepted(stalled, paired, context):
    assert with_pair(stalled, replace(context, pairs=0)) is stalled
    assert with_pair(stalled, replace(context, rules=Rules(most_effects=1))) is stalled
    assert with_pair(paired, context) is paired


def test_to_first_order_the_effects_take_what_their_refit_takes(stalled, context):
    """Both are linear: their columns promise what the refit of both finds."""
    base, split = stalled.final, context.split
    candidates = [Candidate(effect_named(name), "carriage") for name in ("linear_stiffness", "offset")]
    shown = [seen(one, None, base, split) for one in candidates]
    (promise,) = promises(shown, 0.999)
    alone = [
        1 - refit(one.added_to(base.model), split, [base.values], base).cost / base.cost for one in candidates
    ]
    both = refit(candidates[1].added_to(candidates[0].added_to(base.model)), split, [base.values], base)
    assert promise.share == pytest.approx(1 - both.cost / base.cost / (1 - max(alone)), abs=0.05)


def test_a_limit_that_nothing_reaches_shows_its_differences(stalled, context):
    """At zero it has no derivative."""
    (trial,) = (t for t in stalled.steps[0].trials if t.candidate.effect.id == "input_saturation")
    shown = seen(trial.candidate, None, stalled.final, context.split)
    assert shown.shapes
    assert all(any(shape.start.values()) for shape in shown.shapes)


def test_of_a_linear_effect_its_trial_changed_what_its_derivative_says(stalled, context):
    (trial,) = (t for t in stalled.steps[0].trials if t.candidate.effect.id == "offset")
    first, last = seen(trial.candidate, trial, stalled.final, context.split).shapes
    assert first.start == {f"{OFFSET}.offset": 0.0}
    assert last.start == {f"{OFFSET}.offset": trial.own("values")["offset"]}
    changed = first.columns[:, 0] * last.start[f"{OFFSET}.offset"]
    assert np.linalg.norm(last.columns[:, 0] - changed) < 0.1 * np.linalg.norm(changed)
    assert last.positive == (True,)


def test_a_pair_is_withdrawn_as_a_whole(paired):
    rules = Rules(majority=1.0)
    ended = unless_minor(paired, rules.far + 1, rules)
    assert ended.accepted == ()
    assert ended.final is paired.first
    (step,) = ended.steps
    assert step.taken == ()
    assert [pair.status for pair in step.pairs if pair.name == f"{SPRING} + {OFFSET}"] == [REJECTED]
    assert ended.stopped.startswith(f"{SPRING} + {OFFSET} may stand in for something else")


def test_a_pair_takes_the_place_of_effects_only_if_it_explains_more(stalled, paired, context):
    """An effect that bends as the spring does may have been accepted first."""
    said = []
    one = replace(context, pairs=1, say=said.append)
    bent = replace(stalled, accepted=(SimpleNamespace(name="carriage.bend"),))
    better = in_place(bent, one)
    assert {effect.name for effect in better.accepted} == {SPRING, OFFSET}
    assert said[0] == "pairs in place of carriage.bend"
    as_good = replace(bent, final=paired.final)
    assert in_place(as_good, one) is as_good
    assert in_place(better, one) is better
    assert in_place(stalled, one) is stalled


def test_where_nothing_is_missing_no_pair_is_accepted(make_model, split_of):
    """None promises what would be worth a refit; those that are refitted nevertheless do not pass."""
    beyond_noise = Rules(near_floor=0.0)
    context = Context(split_of(n=500, offset=0.0), TRIED, beyond_noise)
    stalled = search(make_model(DECLARED), context, [{}])
    assert with_pair(stalled, context).steps[-1].pairs == ()
    found = with_pair(stalled, replace(context, rules=replace(beyond_noise, worth=1e-6)))
    assert len(found.steps[-1].pairs) > 0
    assert found.accepted == ()


def test_where_strangers_explain_as_much_no_pair_is_accepted(stalled, context, monkeypatch):
    monkeypatch.setattr(pair_decision, "_strangers", lambda *given: "these records cannot tell it from b")
    found = with_pair(stalled, replace(context, pairs=1))
    assert found.accepted == ()
    (pair,) = found.steps[-1].pairs
    assert pair.reason == "withdrawn: these records cannot tell it from b"
