"""Simulated carriages traced: what was planted is named, nothing is found where nothing is missing."""

from __future__ import annotations

import pickle
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.effects.over import OVERS, OVERS_OF_A_FLOW, Over
from hybridid.simulation.stability import TooStiff
from hybridid.trace import ceiling as ceiling_module
from hybridid.trace import search as searching
from hybridid.trace import stand_in
from hybridid.trace.candidates import Candidate
from hybridid.trace.ceiling import ceiling
from hybridid.trace.context import Context
from hybridid.trace.learned_effort import learned_effort
from hybridid.trace.numerics import Numerics
from hybridid.trace.refit import refit
from hybridid.trace.robustness import objection, refitted_under, survival, variations
from hybridid.trace.rules import Rules
from hybridid.trace.search import search
from hybridid.trace.steps import AT_SIMULATION, Accepted, Search, Step
from hybridid.trace.trial import attempt
from hybridid.trace.verdict import conclude

DF_V = 80.0
TRIED = tuple(
    effect_named(name)
    for name in (
        "stribeck",
        "asymmetric_viscous",
        "asymmetric_coulomb",
        "quadratic_drag",
        "cubic_stiffness",
        "input_gain",
    )
)


@pytest.fixture(scope="module")
def decided():
    """The lines that a trace says of its steps."""
    return []


@pytest.fixture(scope="module")
def worn(make_model, split_of, decided):
    """A trace of a carriage whose friction differs by direction."""
    return conclude(make_model(), Context(split_of(df_v=DF_V), TRIED, say=decided.append))


def test_a_step_says_what_it_decides(worn, decided):
    gain = worn.accepted[0].trial.gain
    assert decided == [f"step 1: carriage.asymmetric_viscous takes {gain:.1%} off the held-out error"]


def test_what_was_planted_is_named(worn):
    assert worn.verdict == "effect_found"
    (one,) = worn.accepted
    assert one.name == "carriage.asymmetric_viscous"
    assert one.trial.own("values")["df_v"] == pytest.approx(DF_V, rel=0.01)
    assert [t.candidate.name for t in one.alike] == ["carriage.asymmetric_viscous"]


def test_its_gain_survives_every_variation(worn, split_of):
    (one,) = worn.accepted
    names = [numerics.name for numerics in variations(split_of(df_v=DF_V).records)]
    assert [s.variation for s in one.survivals] == names
    assert all(s.survives for s in one.survivals)


def test_the_search_ends_at_the_noise(worn):
    assert worn.search.stopped == "the residual meets the noise floor"
    assert worn.search.final.score.rmse == pytest.approx(2e-6, rel=0.1)
    assert worn.accuracy.noise.item() == pytest.approx(2e-6, rel=0.2)
    assert worn.remains == ()


def test_nothing_is_found_where_nothing_is_missing(make_model, split_of):
    found = conclude(make_model(), Context(split_of(), TRIED))
    assert found.verdict == "nothing_missing"
    assert found.accepted == ()
    assert found.model.terms == make_model().terms


def test_two_effects_are_found_one_after_the_other(make_model, split_of):
    """From viscous friction alone: the Coulomb friction first, then the asymmetry."""
    tried = tuple(map(effect_named, ("coulomb", "offset", "asymmetric_viscous", "quadratic_drag")))
    context = Context(split_of(df_v=DF_V), tried, variables=("velocity", "position"))
    found = conclude(make_model(("viscous", "offset")), context)
    assert [one.name for one in found.accepted] == ["carriage.coulomb", "carriage.asymmetric_viscous"]
    assert found.model.terms[-1].name == "carriage.asymmetric_viscous"


def test_structure_that_no_effect_explains_is_said_to_remain(make_model, split_of):
    """Friction by direction with nothing in the library that knows direction: unexplained, and where."""
    tried = tuple(map(effect_named, ("stribeck", "input_gain")))
    found = conclude(make_model(), Context(split_of(df_v=DF_V), tried, laws=False))
    assert found.verdict == "unexplained"
    assert "at carriage over velocity" in found.remains


def test_a_learned_effort_that_cannot_be_solved_claims_nothing(worn, split_of, monkeypatch):
    def refuse(*arguments, **options):
        raise TooStiff("needs more than 50 steps a sample")

    monkeypatch.setattr(ceiling_module, "refit_if_hopeful", refuse)
    base = worn.search.steps[0].base
    found = ceiling(base, split_of(df_v=DF_V), "carriage", Over("velocity"))
    assert found.failure == "needs more than 50 steps a sample"
    assert (found.gain, found.p_value, found.curve) == (0.0, 1.0, ())
    assert found.refit is base
    assert not found.passes(Rules())


def test_a_learned_effort_is_the_ceiling(worn, split_of):
    """Over velocity it can do what the planted effect did; it looks like it, too."""
    split = split_of(df_v=DF_V)
    base = worn.search.steps[0].base
    over_velocity, over_position = (
        ceiling(base, split, "carriage", Over(of)) for of in ("velocity", "position")
    )
    (one,) = worn.accepted
    assert over_velocity.gain > 0.8 * one.trial.gain
    assert over_position.gain < 0.5 * over_velocity.gain
    fast = [(v, effort) for v, effort, samples in over_velocity.curve if abs(v) > 0.05 and samples > 20]
    assert fast
    for v, effort in fast:
        # the symmetric terms have taken over what of it is odd or constant, so only roughly
        assert effort == pytest.approx(-0.5 * DF_V * abs(v), abs=2.5), v


def test_an_effect_that_the_numerics_made_does_not_survive(make_model, two_records, held_as):
    """Half a sample of delay, from a held force taken for a linear one, is no physics: withdrawn."""
    from hybridid.trace.split import by_record

    first, second = (held_as(record, "foh") for record in two_records())
    split = by_record([first], [second], 50)
    found = search(make_model(), Context(split, (effect_named("input_delay"),)), [{}])
    step = found.steps[0]
    (trial,) = step.trials
    assert trial.gain > 0.05
    assert found.accepted == ()
    assert "does not survive" in trial.reason
    base = step.base
    assert trial.refit is not None
    held = Numerics("held", hold="zoh")
    (poorer,) = refitted_under(base, [held], Context(split))
    again = survival(base, trial.refit, trial.candidate.name, split, held, Rules(), poorer)
    assert not again.survives


def test_what_is_too_stiff_to_be_tried_says_nothing_and_ends_no_trace(worn, split_of):
    base, found = worn.search.first, worn.search.final
    stiff = {name: 1e8 if name.endswith(".f_v") else value for name, value in found.values.items()}
    split, finer = split_of(df_v=DF_V), Numerics("half the step", finer=2)
    given = (worn.accepted[0].name, split, finer, Rules())
    too_stiff = replace(base, values={n: stiff[n] for n in base.values})
    (poorer, none) = (refitted_under(one, [finer], Context(split))[0] for one in (base, too_stiff))
    with_it = survival(base, replace(found, values=stiff), *given, poorer)
    without = survival(too_stiff, found, *given, none)
    for one in (with_it, without):
        assert (one.simulated, one.survives) == (False, True)


def test_an_effect_that_hardly_can_be_tried_otherwise_is_not_believed(worn):
    survived = list(worn.accepted[0].survivals)
    untried = [replace(one, simulated=False) for one in survived]
    half = len(survived) // 2
    assert objection([*survived[:half], *untried[half:]]) == ""
    assert "too stiff to be solved in more than 1 of 4" in objection([*survived[:1], *untried[1:]])
    diverging = replace(untried[0], survives=False)
    assert "does not survive epsilon x 3 (it diverges)" in objection([diverging, *survived[1:]])


@pytest.mark.parametrize(
    ("share", "over", "contained", "lasts", "trusted"),
    [
        (0.05, "velocity", False, True, True),
        (0.3, "velocity", False, True, False),
        (0.3, "velocity", False, False, True),
        (0.3, "velocity", True, True, True),
        (0.6, "velocity", True, True, False),
        (0.6, "position", False, True, True),
    ],
)
def test_a_name_is_trusted_unless_a_learned_effort_does_better_without_it(
    worn, split_of, monkeypatch, share, over, contained, lasts, trusted
):
    """As if the carriage's error could fall further by ``share`` of what effect and learned effort take.

    One over velocity can do what the effect does, if its gain ``lasts`` under other numerics; beside one over
    position the effect is as needed as before. Where it ``contained`` the effect, it must take more.
    """
    if not contained:
        monkeypatch.setattr(stand_in, "is_curve_over", lambda *given: False)
    monkeypatch.setattr(stand_in, "surviving", lambda learned, *given: [0] if lasts else [])
    split = split_of(df_v=DF_V)
    (one,) = worn.accepted
    declared, named = (r.score.loss**2 for r in (worn.search.steps[0].base, one.trial.refit))
    left = share / (1 - share) * (declared - named)  # beyond what the effect took
    raised = replace(worn.search.final, score=scaled(worn.search.final.score, (named + left) / named))
    gain = 1.0 - ((named + left) / (declared + left)) ** 0.5
    trial = replace(one.trial, refit=raised, comparison=replace(one.trial.comparison, gain=gain))
    learned = replace(ceiling(worn.search.final, split, "carriage", Over(over)), gain=0.9, p_value=1e-9)
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
        assert refused.reason.startswith("stands in for something else")
        assert found.final is step.base


@pytest.mark.parametrize(
    ("accepted", "refused_as", "trusted"),
    [
        ("linear_stiffness", "unidentifiable", False),
        ("linear_stiffness", "rejected", True),
        ("asymmetric_coulomb", "unidentifiable", True),  # a look-alike of the rival
    ],
)
def test_an_undetermined_effect_that_explains_more_withdraws_the_name(
    worn, split_of, accepted, refused_as, trusted
):
    """As if another effect had been accepted, and the true one were not determined."""
    context = Context(split_of(df_v=DF_V), TRIED)
    base = worn.search.first
    named = attempt(Candidate(effect_named(accepted), "carriage"), base, context.split)
    true = attempt(Candidate(effect_named("asymmetric_viscous"), "carriage"), named.refit, context.split)
    one = Accepted(named, (named,), ())
    steps = (Step(base, (named,), one), Step(named.refit, (replace(true, status=refused_as),), None))
    found = stand_in.unless_rivalled(Search(steps, named.refit, (one,), ""), context)
    assert bool(found.accepted) is trusted
    if not trusted:
        assert "carriage.asymmetric_viscous in its place explains more" in found.withdrawn


def test_a_class_that_shares_nothing_physical_is_no_finding(worn):
    """As if a spring explained the record as well as the friction: two flexible forms, no name."""
    (one,) = worn.accepted
    by_id = {t.candidate.effect.id: t for t in worn.search.steps[0].trials}
    for other, trusted in (("asymmetric_coulomb", True), ("cubic_stiffness", False)):
        alike = replace(one, alike=(one.trial, by_id[other]))
        searched = replace(worn.search, accepted=(alike,))
        found = stand_in.without_mixed_classes(searched)
        assert bool(found.accepted) is trusted, other
        assert (found.withdrawn == "") is trusted
    assert "these records cannot tell it from carriage.cubic_stiffness, physically" in found.withdrawn


@pytest.mark.parametrize(("times", "ends"), [(1.04, True), (1.06, False)])
def test_the_search_ends_at_the_error_of_the_simulation(worn, split_of, monkeypatch, times, ends):
    """As if noise and simulation left so much less than the last model does, far above the noise."""
    accuracy = SimpleNamespace(times=lambda rmse: times)
    monkeypatch.setattr(searching.Accuracy, "of", lambda final, context: accuracy)
    monkeypatch.setattr(searching, "meets_noise_together", lambda base, context: False)
    far = replace(worn.search.final, score=scaled(worn.search.first.score, 1.0))
    context = Context(split_of(df_v=DF_V))
    assert (searching._nothing_to_seek(far, worn.accepted, context) == AT_SIMULATION) is ends
    assert searching._nothing_to_seek(far, (), context) == "", "the declared model may lack what hides there"


def test_the_search_ends_at_two_classes_that_chance_decides(worn, split_of, monkeypatch):
    """As if a spring explained the record as well as either of two frictions."""
    (one,), (step, *_) = worn.accepted, worn.search.steps
    by_id = {t.candidate.effect.id: t for t in step.trials}
    drag, spring, context = by_id["quadratic_drag"], by_id["cubic_stiffness"], Context(split_of(df_v=DF_V))
    first, second = replace(one, alike=(one.trial, spring)), replace(one, trial=drag, alike=(drag, spring))

    def why(*accepted):
        return searching._by_chance_alone(worn.search.final, accepted, context)

    assert why(first, second) == ""  # in the last model the spring explains less than the first
    monkeypatch.setattr(searching, "still_alike", lambda *_: True)
    both = (
        "neither carriage.asymmetric_viscous nor carriage.quadratic_drag can be told from effects unrelated"
    )
    assert why(first, second).startswith(both)
    assert why(first, replace(second, alike=(drag,))) == ""
    assert why(first) == ""


def test_what_a_withdrawn_effect_had_made_needless_is_back(worn):
    """As if a first effect had been taken out when the second was accepted, which is then withdrawn."""
    (first,), (step, *_) = worn.accepted, worn.search.steps
    drag = next(t for t in step.trials if t.candidate.effect.id == "quadratic_drag")
    spring = next(t for t in step.trials if t.candidate.effect.id == "cubic_stiffness")
    second = replace(first, trial=drag, alike=(drag, spring))
    later = replace(step, base=worn.search.final, accepted=second, dropped=(first.name,))
    searched = replace(worn.search, steps=(step, later), accepted=(second,), final=drag.refit)
    found = stand_in.without_mixed_classes(searched)
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
        assert found.stopped.startswith("carriage.asymmetric_viscous stands in for something else: ")


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


def scaled(score, factor):
    """Every horizon's and every block's squares times ``factor``."""
    return replace(score, squares=score.squares * factor, block_squares=score.block_squares * factor)


@pytest.mark.parametrize(
    ("kind", "over"), [*(("effort", over) for over in OVERS), *(("flow", over) for over in OVERS_OF_A_FLOW)]
)
def test_a_learned_effort_can_be_sent_to_another_process(kind, over):
    effect = learned_effort(kind, over, np.linspace(-1.0, 1.0, 50))
    assert pickle.loads(pickle.dumps(effect)) == effect


def test_a_damping_that_changes_over_the_way_is_told_by_its_ceiling(make_model, split_of):
    """Friction that rises along the screen: the learned damping over position finds more than any other."""
    base = refit(make_model(), split_of(damping_slope=600.0))
    ceilings = {over: ceiling(base, split_of(damping_slope=600.0), "carriage", over) for over in OVERS}
    assert max(ceilings, key=lambda over: ceilings[over].gain) == Over("position", "velocity")
    assert ceilings[Over("position", "velocity")].gain > 0.5
