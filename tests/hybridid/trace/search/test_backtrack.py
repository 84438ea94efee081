"""On a simulated carriage: a search goes back to a step that took an effect in the place of another."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit
from hybridid.trace.search import search
from hybridid.trace.search.backtrack import better_branch, both_taken, without_the_better
from hybridid.trace.search.search import continued, of_constant_amplitude
from hybridid.trace.search.steps import AT_FLOOR, Accepted, Search, Step
from hybridid.trace.trials.judgement import judge
from hybridid.trace.trials.trial import PASSED, REJECTED, attempt

TRIED = tuple(map(effect_named, ("coulomb", "eddy_brake", "asymmetric_viscous")))


@pytest.fixture(scope="module")
def context(split_of):
    return Context(split_of(df_v=75.0), TRIED)


def step(base, context, *names):
    """The last of ``names`` accepted beside ``base``, and a trial of each."""
    tried = [attempt(Candidate(effect_named(name), "carriage"), base, context.split) for name in names]
    trials = tuple(judge(tried, context.rules))
    return Step(base, trials, Accepted(trials[-1], trials[-1:], ()))


@pytest.fixture(scope="module")
def steps(make_model, context):
    """As if an eddy-current brake had been taken for the Coulomb friction, then the asymmetry was found."""
    first = step(refit(make_model(("viscous", "offset")), context.split), context, "coulomb", "eddy_brake")
    second = step(first.accepted.trial.refit, context, "asymmetric_viscous")
    assert {t.status for t in (*first.trials, *second.trials)} == {PASSED}
    return [first, second]


@pytest.fixture(scope="module")
def last(steps):
    return steps[-1].accepted.trial.refit


def test_the_effect_that_explains_more_beside_what_followed_is_found(steps, last, context):
    better = better_branch(steps, last, (), context)
    assert better is not None
    assert (better.number, str(better)) == (0, "carriage.coulomb + carriage.asymmetric_viscous")
    assert better.refit.score.loss < 0.2 * last.score.loss


def test_an_effect_that_was_removed_and_taken_again_has_no_earlier_place(steps, last, context):
    """As if the brake had been removed after the second step, and were the third that was taken."""
    first, second = steps
    assert first.accepted.name in [term.name for term in last.model.terms]
    assert better_branch([first, second, replace(first, base=last)], last, (), context) is None


def test_what_took_more_in_that_step_is_refused_with_the_reason(steps, last, context):
    better = better_branch(steps, last, (), context)
    one, other = steps[0].trials
    most = replace(other, comparison=replace(other.comparison, gain=0.999))
    coulomb, brake = without_the_better(replace(steps[0], trials=(one, most)), better)
    assert (coulomb.status, brake.status) == (PASSED, REJECTED)
    assert brake.reason.startswith("beside carriage.asymmetric_viscous, found later, carriage.coulomb")


def test_the_search_goes_back_and_ends_at_the_noise(steps, last, context):
    said = []
    accepted = tuple(one.accepted for one in steps)
    found = continued(Search(tuple(steps), last, accepted, ""), replace(context, say=said.append))
    assert [one.name for one in found.accepted] == ["carriage.coulomb", "carriage.asymmetric_viscous"]
    assert found.stopped == AT_FLOOR
    assert "back to step 1" in said[0]


def test_what_is_refused_alone_is_taken_with_what_followed(steps, last, context, monkeypatch):
    def coulomb_differs(alike, context):
        kept, refused = of_constant_amplitude(alike, context)
        friction = [one for one in kept if one.candidate.name == "carriage.coulomb"]
        others = tuple(one for one in kept if one not in friction)
        return others, {**refused, **{one.candidate.name: replace(one, status=REJECTED) for one in friction}}

    monkeypatch.setattr(search, "of_constant_amplitude", coulomb_differs)
    said, accepted = [], tuple(one.accepted for one in steps)
    found = continued(Search(tuple(steps), last, accepted, ""), replace(context, say=said.append))
    assert [one.name for one in found.accepted] == ["carriage.coulomb", "carriage.asymmetric_viscous"]
    assert found.accepted[0].together == "carriage.asymmetric_viscous"
    assert found.stopped == AT_FLOOR
    assert said[0].endswith("off the held-out error, only together")


def test_where_the_two_fail_as_a_pair_nothing_is_taken(steps, last, context):
    better = better_branch(steps, last, (), context)
    hopeless = replace(better, rival=steps[0].trials[1])  # the brake, beside the asymmetry
    left = both_taken(steps[0], hopeless, replace(context, rules=replace(context.rules, worth=0.99)))
    assert left.taken == ()
    assert [pair.status for pair in left.pairs] == [REJECTED]
    assert both_taken(steps[0], better, replace(context, pairs=0)).taken == (), "no pairs were asked for"


def test_a_step_to_which_the_search_went_back_stays(steps, last, context):
    assert better_branch(steps, last, {0}, context) is None


def test_there_is_nothing_to_go_back_to_in_the_first_step(steps, context):
    assert better_branch(steps[:1], steps[1].base, (), context) is None
