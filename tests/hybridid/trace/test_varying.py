"""On simulated carriages: an amplitude that is no constant is told, with the variable that it depends on."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.effects.over import Over
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.refit import refit
from hybridid.trace.search import Accepted, Search, Step
from hybridid.trace.split import by_record
from hybridid.trace.stand_in import unless_varying
from hybridid.trace.trial import attempt
from hybridid.trace.varying import not_constant, varying

VARIABLES = ("velocity", "position")


@pytest.fixture(scope="module")
def context(split_of):
    return Context(split_of(df_v=80.0), (), variables=VARIABLES)


@pytest.fixture(scope="module")
def base(make_model, context):
    return refit(make_model(), context.split)


@pytest.fixture(scope="module")
def named(base, context):
    """``named(effect)``: its trial beside the declared model, whose friction lacks the direction."""
    return lambda effect: attempt(Candidate(effect_named(effect), "carriage"), base, context.split)


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


def test_friction_that_grows_with_the_speed_has_no_constant_amplitude(named, base, context):
    """Viscous friction by direction, named as Coulomb friction by direction."""
    trial = named("asymmetric_coulomb")
    accused = not_constant(trial.refit, [trial.candidate.name], context)
    assert accused is not None
    name, why = accused
    assert name == "carriage.asymmetric_coulomb"
    assert why.startswith("its amplitude is no constant: as a function of velocity it takes 9")
    accepted = Accepted(trial, (trial,), ())
    found = Search((Step(base, (trial,), accepted),), trial.refit, (accepted,), "")
    kept = unless_varying(found, context)
    assert kept.accepted == ()
    assert kept.final is base
    assert why in kept.withdrawn


def test_the_truth_has_a_constant_amplitude(named, context):
    trial = named("asymmetric_viscous")
    assert not_constant(trial.refit, [trial.candidate.name], context) is None


def test_an_effect_of_a_signal_has_no_amplitude_to_free(make_model, two_records):
    first, second = two_records(df_v=80.0)
    split = by_record([first], [second], 50)
    model = make_model().plus(effect_named("input_gain"), "force")
    assert not_constant(refit(model, split), ["force.input_gain"], Context(split, ())) is None
