"""A hidden Dahl friction, which Bouc-Wen's hysteresis beats by the smoothing of sign(v) alone. Simulated.

Scenario 73 of series 1000: 3 % of Dahl's friction beside the Coulomb friction of a carriage.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks.drawn import amount
from benchmarks.drawn.draw import draw_of
from benchmarks.drawn.machines import case_of
from benchmarks.drawn.oracle import split_of
from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.refits.refit import refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.search import decided
from hybridid.trace.trials.alike import tells_apart
from hybridid.trace.trials.exchange import still_alike
from hybridid.trace.trials.judgement import judge
from hybridid.trace.trials.smoothed_apart import _alike_there, _narrower
from hybridid.trace.trials.trial import attempt

SCENARIO = 10_000_073
TRIED = tuple(map(effect_named, ("bouc_wen", "dahl", "maxwell")))


@pytest.fixture(scope="module")
def context():
    draw = draw_of(SCENARIO)
    assert draw.key.endswith("carriage.dahl/3%/noise1.8e-05/moves")
    return Context(split_of(case_of(draw), amount.records_of(draw)), TRIED, Rules())


@pytest.fixture(scope="module")
def trials(context):
    base = refit(case_of(draw_of(SCENARIO)).model(), context.split)
    found = [attempt(Candidate(effect, "carriage"), base, context.split) for effect in TRIED]
    return base, judge(found, context.rules)


def test_what_only_the_smoothing_tells_apart_is_one_class(context, trials):
    base, (bouc_wen, dahl, maxwell) = trials
    assert tells_apart(compare(dahl.refit.score, bouc_wen.refit.score), context.rules), "as declared"
    step = decided(base, [bouc_wen, dahl, maxwell], context)
    assert [t.candidate.name for t in step.accepted.alike] == ["carriage.dahl", "carriage.bouc_wen"]
    assert step.accepted.trial is dahl, "it has fewer parameters"


def test_it_stays_one_class_in_the_last_model(context, trials):
    _, (bouc_wen, dahl, maxwell) = trials
    told = [still_alike(bouc_wen.refit, bouc_wen, t, context.split, context.rules) for t in (dahl, maxwell)]
    assert told == [True, False]


def test_what_has_not_converged_or_explains_less_there_tells_nothing(context, trials):
    _, (bouc_wen, dahl, _) = trials
    best, rules = bouc_wen.refit, context.rules
    there, other = (_narrower(t.refit, context.split) for t in (bouc_wen, dahl))
    assert there.converged
    assert _alike_there(best, there, other, rules)
    assert not _alike_there(best, replace(there, converged=False), other, rules)
    sharper = replace(bouc_wen.refit, score=replace(best.score, squares=0.8 * best.score.squares))
    assert not _alike_there(sharper, there, other, rules), "a friction as smooth as declared"
    assert not _alike_there(best, None, other, rules)
