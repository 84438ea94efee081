"""Where few horizons judge, both sides do: more is seen, and no more of what is not there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.score import score_of
from hybridid.trace.refits.refit import refit, refit_if_possible
from hybridid.trace.trials.cross_fitting import FEW, cross_fitted, joined
from hybridid.trace.trials.judgement import decided_at
from hybridid.trace.trials.trial import PASSED, REJECTED, attempt


@pytest.fixture(scope="module")
def tried(make_model, split_of):
    """A friction that differs by direction, tried beside the declared model, and that model; 16 judge."""
    context = Context(split_of(std=5e-5, df_v=80.0))
    base = refit(make_model(), context.split)
    candidate = Candidate(effect_named("asymmetric_viscous"), "carriage")
    return attempt(candidate, base, context.split), base, context


def test_what_the_horizons_that_judge_leave_open_both_sides_decide(tried):
    trial, base, context = tried
    assert len(context.split.held_out) < FEW
    left_open = decided_at(trial, 0.02, context.rules)
    assert left_open.status == REJECTED
    (decided,) = cross_fitted([left_open], base, context)
    assert decided.status == PASSED
    assert decided.p_adjusted < 1e-6
    assert decided.gain == trial.gain, "the gain is that of the horizons that judge"


def test_what_has_passed_and_what_is_not_worth_having_stay(tried):
    trial, base, context = tried
    passed = decided_at(trial, 1e-4, context.rules)
    little = decided_at(replace(trial, comparison=replace(trial.comparison, gain=0.03)), 0.02, context.rules)
    assert cross_fitted([passed, little], base, context) == [passed, little]


def test_many_horizons_judge_alone(tried):
    trial, base, context = tried
    left_open = decided_at(trial, 0.02, context.rules)
    numbers = tuple(range(FEW))
    many = replace(context, split=replace(context.split, held_out=numbers, fitted=numbers))
    assert cross_fitted([left_open], base, many) == [left_open]


def test_an_effect_that_is_not_there_passes_less_often_than_the_level():
    """One amplitude, fitted to either side, of a signal that the errors do not hold."""
    generator, level = np.random.default_rng(3), 0.05
    passed = 0
    for _ in range(200):
        errors, signal = generator.normal(size=(2, 12, 40, 1))
        sides = []
        for ours, theirs in ((slice(0, None, 2), slice(1, None, 2)), (slice(1, None, 2), slice(0, None, 2))):
            amplitude = (errors[ours] * signal[ours]).sum() / (signal[ours] ** 2).sum()
            left = errors - amplitude * signal
            sides.append([score_of(list(e[ours]), list(e[theirs]), np.ones(1)) for e in (errors, left)])
        (poorer, richer), (poorer_there, richer_there) = sides
        passed += compare(joined(poorer, poorer_there), joined(richer, richer_there)).p_value <= level
    assert passed <= 200 * level


def test_a_fit_that_has_not_converged_decides_nothing(tried, monkeypatch):
    """Of the poorer model, what it leaves too much would count for the effect."""
    trial, base, context = tried
    left_open = decided_at(trial, 0.02, context.rules)
    halfway = lambda *given: replace(refit_if_possible(*given), converged=False)  # noqa: E731
    monkeypatch.setattr("hybridid.trace.trials.cross_fitting.refit_if_possible", halfway)
    assert cross_fitted([left_open], base, context) == [left_open]
