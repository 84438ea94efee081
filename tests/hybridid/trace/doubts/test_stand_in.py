"""Names that only stand in for something else are withdrawn (simulated)."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.effects.over import Over
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.doubts import stand_in
from hybridid.trace.learned.ceiling import ceiling
from hybridid.trace.rules import Rules
from hybridid.trace.search.steps import Accepted, Search, Step
from hybridid.trace.trials.trial import attempt


def scaled(score, factor):
    """Every horizon's and every block's squares times ``factor``."""
    return replace(score, squares=score.squares * factor, block_squares=score.block_squares * factor)


@pytest.mark.parametrize(
    ("share", "over", "contained", "lasts", "near", "trusted"),
    [
        (0.05, "velocity", False, True, True, True),
        (0.05, "velocity", False, True, False, False),
        (0.05, "velocity", True, True, False, True),
        (0.05, "position", False, True, False, True),
        (0.3, "velocity", False, True, True, False),
        (0.3, "velocity", False, False, True, True),
        (0.3, "velocity", True, True, True, True),
        (0.6, "velocity", True, True, True, False),
        (0.6, "position", False, True, True, True),
    ],
)
def test_a_name_is_trusted_unless_a_learned_effort_does_better_without_it(
    worn, worn_context, monkeypatch, share, over, contained, lasts, near, trusted
):
    """As if the carriage's error could fall further by ``share`` of what effect and learned effort take.

    One over velocity can do what the effect does, if its gain ``lasts`` under other numerics; beside one over
    position the effect is as needed as before. Where it ``contained`` the effect, it must take more. So must
    it where what is left is ``near`` the noise; else most of that is enough.
    """
    monkeypatch.setattr(stand_in, "_contained", lambda *given: contained)
    monkeypatch.setattr(stand_in, "_leaves_little", lambda *given: near)
    monkeypatch.setattr(stand_in, "surviving", lambda learned, *given: [0] if lasts else [])
    split = worn_context.split
    (one,) = worn.accepted
    declared, named = (r.score.loss**2 for r in (worn.search.steps[0].base, one.trial.refit))
    left = share / (1 - share) * (declared - named)  # beyond what the effect took
    raised = replace(worn.search.final, score=scaled(worn.search.final.score, (named + left) / named))
    gain = 1.0 - ((named + left) / (declared + left)) ** 0.5
    trial = replace(one.trial, refit=raised, comparison=replace(one.trial.comparison, gain=gain))
    learned = replace(ceiling(worn.search.final, split, "carriage", Over(over)), gain=0.9, p_alone=1e-9)
    step = replace(
        worn.search.steps[0],
        base=replace(
            worn.search.steps[0].base,
            score=scaled(worn.search.steps[0].base.score, (declared + left) / declared),
        ),
        accepted=replace(one, trial=trial),
    )
    searched = replace(worn.search, steps=(step,), final=raised)
    found = stand_in.without_stand_ins(searched, [learned], Context(split))
    assert [a.name for a in found.accepted] == (["carriage.asymmetric_viscous"] if trusted else [])
    if not trusted:
        (refused,) = [t for t in found.steps[0].trials if t.candidate.name == one.name]
        assert refused.status == "rejected"
        assert refused.reason.startswith("may stand in for something else")
        assert found.final is step.base


@pytest.mark.parametrize(
    ("over", "curve", "left", "contained"),
    [
        ("velocity", 1.0, 1e-3, True),
        ("velocity", 0.95, 1e-3, True),  # its own variable
        ("position", 0.95, 1e-3, False),
        ("position", 0.9999, 1e-3, True),
        ("position", 0.95, 0.1, True),
        ("position", 0.8, 0.1, False),
    ],
)
def test_a_learned_effort_contains_what_it_could_leave(worn, monkeypatch, over, curve, left, contained):
    """As if the effort of the asymmetric friction were such a ``curve`` over the variable, and the learned
    effort left so much of what the effect takes."""
    monkeypatch.setattr(stand_in, "share_over", lambda *given: curve)
    (one,) = worn.accepted
    loss = (left * one.trial.taken) ** 0.5
    learned = SimpleNamespace(
        port="carriage", over=Over(over), refit=SimpleNamespace(score=SimpleNamespace(loss=loss))
    )
    assert stand_in._contained(worn.search.final, one, learned, None) is contained


@pytest.mark.parametrize(
    ("accepted", "refused_as", "trusted"),
    [
        ("linear_stiffness", "unidentifiable", False),
        ("linear_stiffness", "rejected", True),
        ("asymmetric_coulomb", "unidentifiable", True),  # a look-alike of the rival
    ],
)
def test_an_undetermined_effect_that_explains_more_withdraws_the_name(
    worn, worn_context, accepted, refused_as, trusted
):
    """As if another effect had been accepted, and the true one were not determined."""
    context, base = worn_context, worn.search.first
    named = attempt(Candidate(effect_named(accepted), "carriage"), base, context.split)
    true = attempt(Candidate(effect_named("asymmetric_viscous"), "carriage"), named.refit, context.split)
    one = Accepted(named, (named,), ())
    steps = (Step(base, (named,), one), Step(named.refit, (replace(true, status=refused_as),), None))
    found = stand_in.unless_rivalled(Search(steps, named.refit, (one,), ""), context)
    assert bool(found.accepted) is trusted
    if not trusted:
        assert "carriage.asymmetric_viscous in its place explains more" in found.withdrawn


@pytest.mark.parametrize(
    ("other", "little_left", "trusted"),
    [
        ("asymmetric_coulomb", False, True),
        ("linear_stiffness", True, True),
        ("linear_stiffness", False, False),
        ("cubic_stiffness", True, False),
    ],
)
def test_a_class_that_shares_nothing_physical_is_no_finding(
    worn, worn_context, monkeypatch, other, little_left, trusted
):
    """As if another law explained the record as well as the friction. One that can bend may have bent to it;
    one that cannot is as likely, where noise is all that is left."""
    monkeypatch.setattr(stand_in, "_leaves_little", lambda found, context: little_left)
    (one,) = worn.accepted
    by_id = {t.candidate.effect.id: t for t in worn.search.steps[0].trials}
    candidate = Candidate(effect_named(other), "carriage")
    rival = by_id.get(other) or replace(one.trial, candidate=candidate)
    alike = replace(one, alike=(one.trial, rival))
    found = stand_in.without_mixed_classes(replace(worn.search, accepted=(alike,)), worn_context)
    assert bool(found.accepted) is trusted
    assert (found.withdrawn == "") is trusted
    if not trusted:
        assert f"these records cannot tell it from carriage.{other}, physically" in found.withdrawn


def test_what_the_noise_leaves_is_little(worn, worn_context):
    assert stand_in._leaves_little(worn.search, worn_context)
    poor = replace(worn.search, final=worn.search.first, stopped="")
    assert not stand_in._leaves_little(poor, worn_context)


def test_what_a_withdrawn_effect_had_made_needless_is_back(worn, worn_context, monkeypatch):
    """As if a first effect had been taken out when the second was accepted, which is then withdrawn."""
    (first,), (step, *_) = worn.accepted, worn.search.steps
    drag = next(t for t in step.trials if t.candidate.effect.id == "quadratic_drag")
    spring = next(t for t in step.trials if t.candidate.effect.id == "cubic_stiffness")
    second = replace(first, trial=drag, alike=(drag, spring))
    later = replace(step, base=worn.search.final, accepted=second, dropped=(first.name,))
    searched = replace(worn.search, steps=(step, later), accepted=(second,), final=drag.refit)
    monkeypatch.setattr(stand_in, "_leaves_little", lambda found, context: False)
    found = stand_in.without_mixed_classes(searched, worn_context)
    assert [one.name for one in found.accepted] == [first.name]
    assert found.final is worn.search.final


@pytest.mark.parametrize(("share", "trusted"), [(0.05, True), (0.3, False)])
def test_effects_that_one_learned_effort_outdoes_are_withdrawn(worn, share, trusted):
    """As if they left half of the squared error, and the learned effort alone took ``share`` of what it takes
    beyond what they do."""
    base = worn.search.steps[0].base
    named = replace(worn.search.final, score=scaled(base.score, 0.5))
    alone = replace(worn.search.final, score=scaled(base.score, (0.5 - share) / (1 - share)))
    learned = replace(worn.ceilings[0], refit=alone)
    found = stand_in.unless_outdone(replace(worn.search, final=named), [learned], Rules())
    assert [a.name for a in found.accepted] == (["carriage.asymmetric_viscous"] if trusted else [])
    if not trusted:
        assert "all effects accepted take 50.0%" in found.stopped


@pytest.mark.parametrize(
    ("left", "times", "trusted"), [(0.4, 9.0, True), (0.6, 2.9, True), (0.6, 3.1, False)]
)
def test_effects_that_take_less_than_half_of_an_error_far_above_the_noise_are_no_names(
    worn, left, times, trusted
):
    """As if the accepted effect left this share of the squared error, after a step that found nothing."""
    base = worn.search.steps[0].base
    final = replace(worn.search.final, score=scaled(base.score, left))
    steps = (Step(base, (), None), *worn.search.steps)
    found = stand_in.unless_minor(replace(worn.search, final=final, steps=steps), times, Rules())
    assert [a.name for a in found.accepted] == (["carriage.asymmetric_viscous"] if trusted else [])
    if not trusted:
        assert found.final is base
        assert "the squared error falls by 40%, to 3.1 times the error" in found.withdrawn
        assert found.stopped.startswith("carriage.asymmetric_viscous may stand in for something else: ")


@pytest.mark.parametrize(
    ("left", "shown", "trusted"), [(0.4, False, False), (0.49, False, True), (0.4, True, True)]
)
def test_a_sine_of_less_than_three_periods_that_does_better_withdraws_the_names(worn, left, shown, trusted):
    """As if the names left half of the squared error, and a sine that is refused as a name left ``left``."""
    first = worn.search.steps[0]
    named = replace(worn.search.final, score=scaled(first.base.score, 0.5))
    sine = replace(
        next(t for t in first.trials if t.candidate.name != "carriage.asymmetric_viscous"),
        refit=replace(worn.search.final, score=scaled(first.base.score, left)),
        status="unidentifiable",
        not_shown="" if shown else "3 periods are needed",
    )
    step = replace(first, trials=(*first.trials, sine))
    found = stand_in.unless_outdone(replace(worn.search, steps=(step,), final=named), (), Rules())
    assert bool(found.accepted) is trusted
    if not trusted:
        assert "whose form the records do not show" in found.withdrawn
