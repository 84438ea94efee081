"""A proposed law adds up with what is declared as a constant times its factor (simulated carriage)."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.cautions.shared_constant import shares_a_constant
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit


@pytest.mark.parametrize(
    ("law", "beside"),
    [
        ("exponential_rise_of_position_times_velocity", "carriage.viscous"),
        ("exponential_rise_of_position_times_sign_of_velocity", "carriage.coulomb"),
        ("exponential_rise_of_position_times_acceleration", ""),  # no constant inertia is an effect here
        ("power_above_of_position_times_velocity", ""),  # nothing below its place
        ("modulus_of_velocity", ""),  # of the velocity itself
        ("quadratic_drag", ""),  # a name
    ],
)
def test_the_declared_constant_beside_a_law_is_told(make_model, split_of, law, beside):
    split = split_of()
    base = refit(make_model(("viscous", "coulomb")), split)
    candidate = Candidate(effect_named(law), "carriage")
    model = candidate.added_to(base.model)
    values = base.values | {p.name: 1.0 for p in model.free if p.name not in base.values}
    final = replace(base, model=model, values=values)
    accepted = (SimpleNamespace(name=candidate.name, trial=SimpleNamespace(candidate=candidate)),)
    found = SimpleNamespace(accepted=accepted, search=SimpleNamespace(final=final))
    said = shares_a_constant(found, Context(split, ()))
    assert said.startswith(f" {beside} and {candidate.name} add up: ") if beside else said == ""
