"""Cubic springs at both axles of a half-car, each with its own amount. Simulated.

Scenario 96 of series 1000 of the drawn league. With one set of parameters at both axles a stop at the front
was named beside them.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from benchmarks.drawn import amount
from benchmarks.drawn.draw import draw_of
from benchmarks.drawn.machines import case_of
from benchmarks.drawn.oracle import split_of
from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.search import decided
from hybridid.trace.search.unequal import each_with_its_own
from hybridid.trace.trials.judgement import judge
from hybridid.trace.trials.trial import attempt

DRAW = draw_of(10_000_096)
FRONT, REAR = "front_suspension", "rear_suspension"
CUBIC = effect_named("cubic_stiffness")


@pytest.fixture(scope="module")
def step():
    assert DRAW.wanted.names == (f"{FRONT}.cubic_stiffness", f"{REAR}.cubic_stiffness")
    context = Context(split_of(case_of(DRAW), amount.records_of(DRAW)), (CUBIC,), Rules(), laws=False)
    base = refit(case_of(DRAW).model(), context.split)
    found = [
        attempt(Candidate(CUBIC, port), base, context.split) for port in (f"{FRONT}+{REAR}", FRONT, REAR)
    ]
    return decided(base, judge(found, context.rules), context), context


def test_each_of_two_alike_gets_its_own_amount(step):
    joint, context = step
    assert joint.accepted.name == f"{FRONT}+{REAR}.cubic_stiffness"
    found = each_with_its_own(joint, context)
    assert sorted(one.name for one in found.taken) == [f"{FRONT}.cubic_stiffness", f"{REAR}.cubic_stiffness"]
    left = found.accepted.trial.refit
    assert left.score.rmse == pytest.approx(DRAW.noise, rel=0.06)
    truth = {one.port: one.values for one in amount.made(DRAW.number).hidden}
    for port in (FRONT, REAR):
        assert left.values[f"{port}.cubic_stiffness.q_0"] == pytest.approx(truth[port]["q_0"], rel=0.1)


def test_what_explains_no_more_stays_at_both(step):
    joint, context = step
    strict = replace(context, rules=replace(context.rules, worth=0.9))
    assert each_with_its_own(joint, strict) is joint


def test_an_effect_at_one_port_and_a_step_without_any_stay(step):
    joint, context = step
    alone = next(t for t in joint.trials if t.candidate.port == REAR)
    for accepted in (None, replace(joint.accepted, trial=alone)):
        given = replace(joint, accepted=accepted)
        assert each_with_its_own(given, SimpleNamespace(rules=context.rules)) is given


def test_an_effect_that_leads_from_one_port_into_another_is_at_no_ports_alike(step):
    joint, context = step
    overflow = Candidate(effect_named("overflow_into"), "upper+lower")
    trial = SimpleNamespace(candidate=overflow, refit=joint.accepted.trial.refit)
    found = replace(joint, accepted=SimpleNamespace(trial=trial))
    assert each_with_its_own(found, context) is found
