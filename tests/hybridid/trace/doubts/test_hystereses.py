"""Two hystereses at one port are told to be the parts of a sum."""

from __future__ import annotations

import pytest

from hybridid.effects.library import effect_named
from hybridid.model import compose
from hybridid.plants.duffing import Duffing
from hybridid.trace.candidates import Candidate
from hybridid.trace.doubts.hystereses import one_impedance, several_hystereses, spread_relaxation
from hybridid.trace.search.steps import Accepted
from hybridid.trace.trials.trial import Trial


def accepted(*names):
    found = (name.split(".") for name in names)
    trials = [Trial(Candidate(effect_named(effect), port), None, None) for port, effect in found]
    return [Accepted(trial, (trial,), ()) for trial in trials]


def test_look_alikes_with_states_at_one_port_are_a_sum():
    assert several_hystereses(accepted("spring.lugre", "spring.cogging", "spring.bouc_wen")) == (
        " Beware: spring.lugre and spring.bouc_wen look alike. Their sum stands for one hysteresis of "
        "another form, and none of them is a name."
    )


@pytest.mark.parametrize(
    "names",
    [
        ("motor.dahl",),
        ("motor.dahl", "link.bouc_wen"),
        ("motor.coulomb", "motor.dahl"),  # dry friction beside a bristle has no state
        ("motor.dahl", "motor.warming_friction"),
        ("motor.backlash", "motor.flexible_mode"),  # loads behind a play or a spring
        ("motor.backlash", "motor.friction_behind_play"),
    ],
)
def test_others_are_names(names):
    assert several_hystereses(accepted(*names)) == ""


def test_a_load_behind_a_spring_and_a_relaxation_at_one_port_are_one_impedance():
    assert one_impedance(accepted("spring.flexible_mode", "spring.cogging", "spring.maxwell")) == (
        " Beware: spring.flexible_mode and spring.maxwell are together one mechanical impedance. Other "
        "networks of masses, springs and dampers have the same, so no experiment there tells whether the "
        "machine holds these."
    )


@pytest.mark.parametrize(
    "names",
    [
        ("motor.flexible_mode",),
        ("motor.flexible_mode", "link.maxwell"),
        ("motor.maxwell", "motor.second_maxwell"),  # branches of one relaxation
        ("motor.flexible_mode", "motor.lugre"),
    ],
)
def test_others_are_no_impedance_of_several_parts(names):
    assert one_impedance(accepted(*names)) == ""


def test_three_maxwell_branches_may_be_one_relaxation():
    two, three = (
        compose(Duffing(), ["maxwell", "second_maxwell", *more]) for more in ((), ("third_maxwell",))
    )
    assert spread_relaxation(two) == ""
    assert "the Maxwell branches at oscillator may stand for a relaxation" in spread_relaxation(three)
