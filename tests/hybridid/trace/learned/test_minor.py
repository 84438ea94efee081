"""On simulated carriages: an effect that takes little beside a learned effort is no name."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.learned.minor import may_be_minor, minor_beside
from hybridid.trace.rules import Rules
from hybridid.trace.search.search import _unless_minor, search
from hybridid.trace.search.steps import Accepted, Search, Step
from hybridid.trace.trials.trial import PASSED, REJECTED

LENIENT = Rules(alpha=0.999, worth=0.01, kept=-9.0, steady=100.0)
"""So that an effect passes that explains little."""
RESEMBLES = "detent"


@pytest.fixture(scope="module")
def context_of(split_of):
    """A trace that tries the named effects; learned efforts depend on the velocity."""

    def make(*names: str, rules: Rules = LENIENT) -> Context:
        tried = tuple(map(effect_named, names))
        return Context(split_of(df_v=80.0), tried, rules, variables=("velocity",))

    return make


@pytest.fixture(scope="module")
def poor(make_model, context_of) -> Search:
    """The search where the library has only what resembles the truth."""
    return search(make_model(), context_of(RESEMBLES), [{}])


def test_an_effect_that_takes_little_is_no_name_and_the_sentence_says_beside_what(poor):
    (step,) = poor.steps
    assert poor.accepted == step.taken == ()
    assert poor.final is step.base
    assert step.trials[0].status == "rejected"
    assert step.trials[0].reason.startswith("minor: it takes ")
    assert poor.stopped == poor.withdrawn == step.minor
    assert "a learned effort at carriage over velocity 9" in step.minor, "it takes more than 90 %"


def test_at_the_noise_no_effect_is_minor(make_model, poor, context_of):
    score = poor.steps[0].trials[0].refit.score
    at_noise = replace(
        LENIENT, near_floor=1.01 * float(score.rmse[0] / context_of(RESEMBLES).noise.beside(score)[0])
    )
    found = search(make_model(), context_of(RESEMBLES, rules=at_noise), [{}])
    assert [one.name for one in found.steps[0].taken] == [f"carriage.{RESEMBLES}"]
    assert found.withdrawn == ""
    assert not any(step.learned for step in found.steps), "nothing was learned where nothing is in doubt"


def test_the_truth_is_not_minor(make_model, context_of):
    found = search(make_model(), context_of("asymmetric_viscous"), [{}])
    first = found.steps[0]
    assert [one.name for one in first.taken] == ["carriage.asymmetric_viscous"]
    assert not first.learned, "what takes most cannot be minor"


def test_a_curve_over_the_learned_variable_is_not_minor(make_model, context_of):
    """It may be one of several effects that the learned effort adds up."""
    found = search(make_model(), context_of("asymmetric_coulomb"), [{}])
    first = found.steps[0]
    assert [one.name for one in first.taken] == ["carriage.asymmetric_coulomb"]
    assert first.learned[0].gain > 0.9 > 2 * first.accepted.trial.gain


def test_a_minor_effect_is_no_name_where_another_that_is_not_minor_passed_too(make_model, context_of):
    """With as few parameters, or fewer, it may be preferred to the one that takes most."""
    context = context_of("asymmetric_coulomb", RESEMBLES)
    first = search(make_model(), context, [{}]).steps[0]
    by_effect = {trial.candidate.effect.id: replace(trial, status=PASSED) for trial in first.trials}
    minor = by_effect[RESEMBLES]
    step = Step(first.base, tuple(by_effect.values()), Accepted(minor, (minor,), ()))
    found = _unless_minor(step, context)
    assert [one.name for one in found.taken] == ["carriage.asymmetric_coulomb"]
    refused = next(trial for trial in found.trials if trial.candidate.effect.id == RESEMBLES)
    assert (refused.status, refused.reason[:5]) == (REJECTED, "minor")
    assert found.learned
    assert found.minor == ""


def test_half_of_what_is_learned_is_enough(poor, context_of):
    (step,) = poor.steps
    (learned,) = step.learned
    context = context_of(RESEMBLES)
    takes = step.base.score.loss**2 - learned.refit.score.loss**2
    share = step.trials[0].taken / takes
    name = step.trials[0].candidate.name
    assert minor_beside(step.trials, step.base, step.learned, context) == {name: learned}
    enough = replace(context, rules=replace(LENIENT, majority=0.99 * share))
    assert minor_beside(step.trials, step.base, step.learned, enough) == {}


def test_what_takes_half_or_ends_at_the_noise_cannot_be_minor(poor, context_of):
    (step,) = poor.steps
    trial, context = step.trials[0], context_of(RESEMBLES)
    share, score = trial.taken / step.base.score.loss**2, trial.refit.score
    assert may_be_minor(trial, step.base, context)
    (times,) = score.rmse / context.noise.beside(score)
    at_noise = replace(LENIENT, near_floor=1.01 * times)
    assert not may_be_minor(trial, step.base, replace(context, rules=at_noise))
    less = replace(context, rules=replace(LENIENT, majority=0.99 * share))
    assert not may_be_minor(trial, step.base, less)
