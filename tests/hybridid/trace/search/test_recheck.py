"""The classes of accepted effects, looked at again in the last model (simulated)."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import Comparison
from hybridid.trace.horizons.split import by_record
from hybridid.trace.rules import Rules
from hybridid.trace.search.recheck import recheck
from hybridid.trace.search.search import search
from hybridid.trace.trials.alike import _nearly_alike, tells_apart
from hybridid.trace.trials.trial import PASSED, REJECTED

HORIZON = 0.25  # s
TWIN = replace(effect_named("asymmetric_viscous"), id="twin", look_alikes=("asymmetric_viscous",))


@pytest.fixture(scope="module")
def context(two_records):
    first, second = two_records(df_v=80.0)
    tried = (effect_named("asymmetric_viscous"), effect_named("quadratic_drag"))
    return Context(by_record([first], [second], round(HORIZON / first.dt)), tried)


@pytest.fixture(scope="module")
def found(make_model, context):
    return search(make_model(), context, [{}])


@pytest.fixture
def passed_before(found, context):
    """As if drag and a second asymmetric friction had passed in an earlier step."""
    drag = next(t for t in found.steps[0].trials if t.candidate.effect.id == "quadratic_drag")
    twin = replace(found.accepted[0].trial, candidate=replace(drag.candidate, effect=TWIN), status=PASSED)
    trials = (*found.steps[0].trials, twin, replace(drag, status=PASSED))
    steps = (replace(found.steps[0], trials=trials), *found.steps[1:])
    return replace(found, steps=steps), replace(context, effects=(*context.effects, TWIN))


def test_a_rival_that_explains_less_in_the_last_model_leaves_the_class(found, context):
    """As if the drag had been alike when the asymmetry was accepted: in the last model it is not."""
    (one,) = found.accepted
    drag = next(t for t in found.steps[0].trials if t.candidate.effect.id == "quadratic_drag")
    doubtful = replace(found, accepted=(replace(one, alike=(one.trial, drag)),))
    (kept,) = recheck(doubtful, context).accepted
    assert kept.alike == (one.trial,)


def test_what_does_as_well_joins_the_class_if_the_effect_was_judged_beside_one_that_is_gone(passed_before):
    found, context = passed_before
    step = found.steps[0]
    beside = replace(step.base, model=step.base.model.plus(effect_named("linear_stiffness"), "carriage"))
    judged_beside_it = replace(found, steps=(replace(step, base=beside), *found.steps[1:]))
    (kept,) = recheck(judged_beside_it, context).accepted
    assert [t.candidate.name for t in kept.alike] == ["carriage.asymmetric_viscous", "carriage.twin"]
    twin = kept.alike[1]
    assert twin.status == PASSED
    assert twin.gain == pytest.approx(kept.trial.gain, rel=1e-3)


def test_what_a_wider_smoothing_kept_out_is_tried_again(passed_before):
    """As if sign(v) had been smoothed over twice the width when the asymmetry was accepted."""
    found, context = passed_before
    step = found.steps[0]
    wider = replace(step.base.model, adjustments={"carriage.epsilon": {"guess": 2e-3}})
    judged_wider = replace(
        found, steps=(replace(step, base=replace(step.base, model=wider)), *found.steps[1:])
    )
    (kept,) = recheck(judged_wider, context).accepted
    assert [t.candidate.name for t in kept.alike] == ["carriage.asymmetric_viscous", "carriage.twin"]


def test_otherwise_nothing_is_tried_again(passed_before):
    found, context = passed_before
    said = []
    (kept,) = recheck(found, replace(context, report=lambda *what: said.append(what))).accepted
    assert len(kept.alike) == 1
    assert said == []


def test_a_rival_that_never_passed_is_not_tried(passed_before):
    found, context = passed_before
    step = found.steps[0]
    beside = replace(step.base, model=step.base.model.plus(effect_named("linear_stiffness"), "carriage"))
    trials = tuple(replace(t, status=REJECTED) for t in step.trials)
    changed = replace(found, steps=(replace(step, base=beside, trials=trials), *found.steps[1:]))
    (kept,) = recheck(changed, context).accepted
    assert len(kept.alike) == 1


@pytest.mark.parametrize(
    ("left", "at_noise", "is_alike"),
    [(2.9, False, True), (3.1, False, False), (1.3, True, True), (1.5, True, False)],
)
def test_a_look_alike_that_leaves_many_times_the_error_is_told_apart(found, left, at_noise, is_alike):
    """However little it is of what the effect takes. Where the best one leaves the noise, a rival that leaves
    more of its own than that is refuted."""
    (one,) = found.accepted
    twin = replace(one.trial, candidate=replace(one.trial.candidate, effect=TWIN))
    best = replace(one.trial, comparison=replace(one.trial.comparison, gain=0.999))
    other = replace(twin, comparison=replace(one.trial.comparison, gain=1 - left * 0.001))
    assert _nearly_alike(best, other, Rules(), at_noise) is is_alike


@pytest.mark.parametrize(
    ("gain", "p_value", "told"),
    [(0.5, 0.009, True), (0.5, 0.012, False), (0.84, 0.012, True), (0.84, 0.06, False), (0.01, 0.0, False)],
)
def test_several_times_the_error_needs_fewer_horizons(gain, p_value, told):
    assert tells_apart(Comparison(gain, p_value, 0.0), Rules()) is told
