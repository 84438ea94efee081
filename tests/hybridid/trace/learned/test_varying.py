"""On simulated carriages: an amplitude that is no constant is told, with the variable that it depends on."""

from __future__ import annotations

import pickle
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.declarations import Signal
from hybridid.effects.library import effect_named
from hybridid.effects.over import Over
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.doubts.stand_in import unless_varying
from hybridid.trace.horizons.split import by_record
from hybridid.trace.learned.varying import _overs, held_at, not_constant, varying
from hybridid.trace.refits.refit import refit
from hybridid.trace.search.steps import Accepted, Search, Step
from hybridid.trace.trials.trial import attempt

TEMPERATURE = Signal("temperature", "°C")


@pytest.fixture(scope="module")
def context(two_records):
    """Carriages whose Coulomb friction grows with the temperature, a channel of their records."""
    first, second = (record.with_channels(["temperature"]) for record in two_records(warming=0.5))
    return Context(by_record([first], [second], 50), (), variables=("velocity", "position", "input"))


@pytest.fixture(scope="module")
def base(make_model, context):
    """The declared model without Coulomb friction."""
    model = replace(make_model(("viscous", "offset")), channels=(TEMPERATURE,))
    return refit(model, context.split)


@pytest.fixture(scope="module")
def named(base, context):
    """``named(effect)``: its trial beside the declared model."""
    return lambda effect: attempt(Candidate(effect, "carriage"), base, context.split)


def test_with_its_shares_at_zero_it_is_the_effect(base):
    effect = effect_named("asymmetric_coulomb")
    free = varying(effect, Over("velocity"), np.linspace(-0.1, 0.1, 50))
    assert {p.name for p in effect.parameters} < {p.name for p in free.parameters}
    again = pickle.loads(pickle.dumps(free))
    assert again.parameters == free.parameters
    assert again.law == free.law
    model = base.model.plus(effect, "carriage")
    other = base.model.plus(free, "carriage")
    values = {**base.values, "carriage.asymmetric_coulomb.df_c": 3.0}
    point = [0.0, [0.01, 0.05], [20.0]]
    ours, theirs = (float(m.efforts(*point, m.values(values))[-1]) for m in (model, other))
    assert ours == theirs != 0.0


def test_the_largest_amplitude_is_held_and_is_sent_to_other_processes():
    """A constant is a function of the variable, too: both would be free."""
    free = held_at({"df_c": 3.0}, varying(effect_named("asymmetric_coulomb"), Over("time"), np.arange(50.0)))
    held = [p for p in pickle.loads(pickle.dumps(free)).parameters if p.nests]
    assert [(p.name, p.guess, p.fixed) for p in held] == [("df_c", 3.0, True)]


def test_an_effect_with_a_state_is_sent_to_other_processes_too():
    """Its dynamics, a lambda, stand in no module beside another law."""
    warming = effect_named("warming_friction")
    free = varying(warming, Over("velocity"), np.linspace(-0.1, 0.1, 50))
    again = pickle.loads(pickle.dumps(free))
    at = SimpleNamespace(speed=3.0, z=SimpleNamespace(w=1.0), p=SimpleNamespace(tau=4.0))
    assert again.dynamics(at) == free.dynamics(at) == {"w": 0.5}


def test_friction_that_follows_a_channel_has_no_constant_amplitude(named, base, context):
    trial = named(effect_named("coulomb"))
    accused = not_constant(trial.refit, [trial.candidate.name], context)
    assert accused is not None
    name, why = accused
    assert name == "carriage.coulomb"
    assert why.startswith("its amplitude is no constant: as a function of temperature it takes ")
    accepted = Accepted(trial, (trial,), ())
    found = Search((Step(base, (trial,), accepted),), trial.refit, (accepted,), "")
    kept = unless_varying(found, context)
    assert kept.accepted == ()
    assert kept.final is base
    assert why in kept.withdrawn


def test_the_truth_has_a_constant_amplitude(named, make_model, split_of):
    context = Context(split_of(df_v=80.0), (), variables=("velocity", "position"))
    model = make_model().plus(effect_named("asymmetric_viscous"), "carriage")
    assert not_constant(refit(model, context.split), ["carriage.asymmetric_viscous"], context) is None


def test_an_amplitude_is_not_freed_over_the_variable_of_the_effect(named, context):
    """It would add up all effects of that variable."""
    trial = named(effect_named("coulomb"))
    over = {str(one) for one in _overs(trial.refit, "carriage.coulomb", context)}
    assert over == {"position", "temperature"}


def test_an_effect_of_a_signal_has_no_amplitude_to_free(make_model, two_records):
    first, second = two_records(df_v=80.0)
    split = by_record([first], [second], 50)
    model = make_model().plus(effect_named("input_gain"), "force")
    assert not_constant(refit(model, split), ["force.input_gain"], Context(split, ())) is None
