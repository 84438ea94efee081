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
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import Comparison
from hybridid.trace.learned import ceiling as ceiling_module
from hybridid.trace.learned.ceiling import ceiling
from hybridid.trace.learned.learned_effort import learned_effort
from hybridid.trace.refits.numerics import Numerics
from hybridid.trace.refits.refit import refit
from hybridid.trace.rules import Rules
from hybridid.trace.search import search as searching
from hybridid.trace.search import stops
from hybridid.trace.search.search import search
from hybridid.trace.search.steps import AT_SIMULATION, RECORDINGS_DIFFER
from hybridid.trace.trials.robustness import objection, refitted_under, survival, variations
from hybridid.trace.trials.trial import PASSED, Trial
from hybridid.trace.verdict import conclude

DF_V = 80.0
"""Of ``worn``."""


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


def test_nothing_is_found_where_nothing_is_missing(make_model, split_of, worn_context):
    found = conclude(make_model(), replace(worn_context, split=split_of()))
    assert found.verdict == "nothing_missing"
    assert found.accepted == ()
    assert found.model.terms == make_model().terms


def test_two_effects_are_found_one_after_the_other(make_model, split_of):
    """From viscous friction alone: the Coulomb friction first, then the asymmetry."""
    tried = tuple(map(effect_named, ("coulomb", "offset", "asymmetric_viscous", "quadratic_drag")))
    context = Context(split_of(df_v=DF_V), tried, variables=("velocity",))
    found = conclude(make_model(("viscous", "offset")), context)
    assert [one.name for one in found.accepted] == ["carriage.coulomb", "carriage.asymmetric_viscous"]
    assert found.model.terms[-1].name == "carriage.asymmetric_viscous"


def test_structure_that_no_effect_explains_is_said_to_remain(make_model, split_of):
    """Friction by direction with nothing in the library that knows direction: unexplained, and where."""
    tried = tuple(map(effect_named, ("stribeck", "input_gain")))
    found = conclude(
        make_model(), Context(split_of(df_v=DF_V), tried, laws=False, variables=("velocity", "position"))
    )
    assert found.verdict == "unexplained"
    assert "at carriage over velocity" in found.remains


def test_a_learned_effort_that_cannot_be_solved_claims_nothing(worn, split_of, monkeypatch):
    def refuse(*arguments, **options):
        raise TooStiff("needs more than 50 steps a sample")

    monkeypatch.setattr(ceiling_module, "refit_if_hopeful", refuse)
    base = worn.search.steps[0].base
    found = ceiling(base, split_of(df_v=DF_V), "carriage", Over("velocity"))
    assert found.failure.startswith("needs more than 50 steps a sample; with rodas3: ")
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
    from hybridid.trace.horizons.split import by_record

    first, second = (held_as(record, "foh") for record in two_records())
    split = by_record([first], [second], 50)
    tried = (effect_named("input_delay"),)
    found = search(make_model(), Context(split, tried, variables=("velocity",)), [{}])
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


def test_a_refusal_says_whether_the_gain_or_an_amplitude_is_lost(worn):
    kept, *others = worn.accepted[0].survivals
    moved, lost = (replace(kept, survives=False, kept=share) for share in (0.65, 0.2))
    assert objection([moved, *others]).startswith("the gain stays, but an amplitude moves with ")
    assert objection([lost, *others]).startswith("the gain does not survive ")
    assert objection([moved, lost, *others]).startswith("the gain does not survive ")


@pytest.mark.parametrize(("times", "ends"), [(1.04, True), (1.06, False)])
def test_the_search_ends_at_the_error_of_the_simulation(worn, split_of, monkeypatch, times, ends):
    """As if noise and simulation left so much less than the last model does, far above the noise."""
    accuracy = SimpleNamespace(times=lambda rmse: times)
    monkeypatch.setattr(stops.Accuracy, "of", lambda final, context: accuracy)
    monkeypatch.setattr(stops, "meets_noise_together", lambda base, context: False)
    far = worn.search.first
    context = Context(split_of(df_v=DF_V))
    assert (stops.nothing_to_seek(far, worn.accepted, context) == AT_SIMULATION) is ends
    assert stops.nothing_to_seek(far, (), context) == "", "the declared model may lack what hides there"


@pytest.mark.parametrize(("times", "why"), [(2.9, ""), (3.1, RECORDINGS_DIFFER)])
def test_beside_one_effect_that_leaves_more_than_own_values_no_other_is_sought(
    worn, split_of, monkeypatch, times, why
):
    """As if values of its own for each recording left no more than noise, and the effect so much more."""
    monkeypatch.setattr(stops.Accuracy, "of", lambda *_: SimpleNamespace(times=lambda rmse: times))
    monkeypatch.setattr(stops, "meets_noise_together", lambda *_: False)
    own_values = Context(split_of(df_v=DF_V), own_values=True)
    assert stops.nothing_to_seek(worn.search.first, worn.accepted, own_values) == why
    alike = replace(own_values, own_values=False)
    assert stops.nothing_to_seek(worn.search.first, worn.accepted, alike) == ""


def test_the_search_ends_at_two_classes_that_chance_decides(worn, split_of, monkeypatch):
    """As if a spring explained the record as well as either of two frictions."""
    (one,), (step, *_) = worn.accepted, worn.search.steps
    by_id = {t.candidate.effect.id: t for t in step.trials}
    drag, spring, context = by_id["quadratic_drag"], by_id["cubic_stiffness"], Context(split_of(df_v=DF_V))
    first, second = replace(one, alike=(one.trial, spring)), replace(one, trial=drag, alike=(drag, spring))

    def why(*accepted):
        return stops.two_mixed_classes(worn.search.final, accepted, context)

    assert why(first, second) == ""  # in the last model the spring explains less than the first
    monkeypatch.setattr(stops, "still_alike", lambda *_: True)
    both = (
        "neither carriage.asymmetric_viscous nor carriage.quadratic_drag can be told from effects unrelated"
    )
    assert why(first, second).startswith(both)
    assert why(first, replace(second, alike=(drag,))) == ""
    assert why(first) == ""


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


def test_of_models_of_one_size_that_judge_alike_the_likelier_fitted_one_is_preferred(monkeypatch):
    """A lag of the sensor that begins in motion: the first held-out horizon speaks against it, all fitted
    ones for it."""
    monkeypatch.setattr(searching, "indistinguishable", lambda best, other, rules: True)

    def tried(name, gain, fitted_gain):
        trial = Trial(Candidate(effect_named(name), "force"), None, Comparison(gain, 1e-9, 1.0), fitted_gain)
        return replace(trial, status=PASSED)

    lag, delay = tried("input_lag", 0.80, 0.90), tried("input_delay", 0.78, 0.98)
    assert searching._preferred([lag, delay], Rules()) is delay
    close = tried("input_delay", 0.78, 0.901)
    assert searching._preferred([lag, close], Rules()) is lag
    larger = tried("input_saturation", 0.79, 0.999)
    assert free(larger) > free(lag)
    assert searching._preferred([lag, larger], Rules()) is lag


def free(trial):
    return sum(not p.fixed for p in trial.candidate.effect.parameters)
