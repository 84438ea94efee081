"""On a simulated carriage: another member of a class leads it where it explains more in the last model."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.class_lead import led_by_the_better
from hybridid.trace.search.search import continued
from hybridid.trace.search.steps import AT_FLOOR, Accepted, Search, Step
from hybridid.trace.trials.judgement import judge
from hybridid.trace.trials.trial import attempt

BRAKE, COULOMB, ASYMMETRY = "carriage.eddy_brake", "carriage.coulomb", "carriage.asymmetric_viscous"


@pytest.fixture(scope="module")
def context(split_of):
    return Context(split_of(df_v=75.0), tuple(map(effect_named, ("asymmetric_viscous", "quadratic_drag"))))


def step(base, context, *names):
    """The last of ``names`` accepted beside ``base`` in a class of all."""
    tried = [attempt(Candidate(effect_named(name), "carriage"), base, context.split) for name in names]
    trials = tuple(judge(tried, context.rules))
    return Step(base, trials, Accepted(trials[-1], trials[::-1], ()))


@pytest.fixture(scope="module")
def steps(make_model, context):
    """As if a brake led the class of the Coulomb friction, and the asymmetry was found beside the brake."""
    first = step(refit(make_model(("viscous", "offset")), context.split), context, "coulomb", "eddy_brake")
    return [first, step(first.accepted.trial.refit, context, "asymmetric_viscous")]


@pytest.fixture(scope="module")
def last(steps):
    return steps[-1].accepted.trial.refit


def test_the_member_that_explains_more_in_the_last_model_leads(steps, last, context):
    asked, said = set(), []
    led = led_by_the_better(steps, last, asked, replace(context, say=said.append))
    (first,), there, (one,) = led
    assert one is first.accepted
    assert (one.name, [t.candidate.name for t in one.alike]) == (COULOMB, [COULOMB, BRAKE])
    assert there is one.trial.refit
    assert all(survival.survives for survival in one.survivals)
    assert asked == {0}
    assert said == [f"with {COULOMB} less error is left: back to step 1"]


def test_the_search_goes_on_beside_it(steps, last, context, monkeypatch):
    """As if the model with the brake met the noise, which ends a search."""
    monkeypatch.setattr(
        "hybridid.trace.search.search.nothing_to_seek",
        lambda base, accepted, context: AT_FLOOR if len(accepted) > 1 else "",
    )
    found = continued(Search(tuple(steps), last, tuple(one.accepted for one in steps), ""), context)
    assert [one.name for one in found.accepted] == [COULOMB, ASYMMETRY]
    assert found.final.score.loss < 0.2 * last.score.loss


def test_a_step_is_asked_once(steps, last, context):
    assert led_by_the_better(steps, last, {0}, context) is None


def test_a_member_that_does_not_explain_more_leads_nothing(steps, last, context):
    picky = replace(context, rules=Rules(tie=0.99))
    assert led_by_the_better(steps, last, set(), picky) is None
    assert led_by_the_better(steps[:1], steps[1].base, set(), context) is None, (
        "the last step is asked already"
    )


def test_a_last_model_that_has_not_converged_loses_to_nobody(steps, last, context):
    assert led_by_the_better(steps, replace(last, converged=False), set(), context) is None


def test_a_gain_that_other_numerics_take_away_leads_nothing(steps, last, context, monkeypatch):
    monkeypatch.setattr(
        "hybridid.trace.search.class_lead.objection", lambda survivals: "not with half the step"
    )
    assert led_by_the_better(steps, last, set(), context) is None
