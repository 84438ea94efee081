"""Composed laws: what each is, at a point, by its name, in another process, and as a file has it."""

from __future__ import annotations

import math
import pickle

import pytest

from hybridid.declarations import Signal
from hybridid.effects.composed import (
    EXPONENTS,
    FORMS,
    composed,
    composed_named,
    is_composed,
    law,
    levels_beside,
)
from hybridid.effects.library import EFFECTS, effect_named
from hybridid.effects.over import (
    FLOW_FACTORS,
    MEMORIES,
    OVERS,
    OVERS_OF_A_FLOW,
    Over,
    over_inputs,
)
from hybridid.effects.shapes import SHAPES, shape_named, shapes_over

FORCE = Signal("force", "N")
EVERY = [
    composed(over, shape)
    for over in (*OVERS, *OVERS_OF_A_FLOW, *over_inputs([FORCE]))
    for shape in shapes_over(over.variable)
]
WITH_LEVEL = [
    composed(over, shape_named("sine"), level=level)
    for over in (Over("position"),)
    for level in levels_beside(over, "effort", [FORCE])
]


@pytest.mark.parametrize("effect", [*EVERY, *WITH_LEVEL], ids=lambda effect: effect.id)
def test_each_vanishes_with_its_amplitudes_and_bears_its_name(effect, value_at):
    amplitudes = {p.name: 0.0 for p in effect.parameters if p.nests}
    assert value_at(effect, **amplitudes) == 0.0
    assert math.isfinite(value_at(effect))
    again = composed_named(effect.id, [FORCE])
    assert again is not None
    assert (again.equation, again.parameters) == (effect.equation, effect.parameters)
    assert is_composed(pickle.loads(pickle.dumps(effect)))


OF_A_FLOW = [
    composed(over, shape, "flow")
    for over in (*OVERS_OF_A_FLOW, *over_inputs([FORCE], FLOW_FACTORS))
    for shape in shapes_over(over.variable)
]


@pytest.mark.parametrize("effect", OF_A_FLOW, ids=lambda effect: effect.id)
def test_each_law_of_a_flow_is_found_by_its_name_and_kind_of_port(effect):
    again = composed_named(effect.id, [FORCE], at="flow")
    assert again is not None
    assert (again.kind, again.parameters) == ("flow", effect.parameters)


def test_a_law_over_an_input_is_one_of_an_effort_unless_told_otherwise():
    kinds = [composed_named("cube_of_force", [FORCE], at=at).kind for at in (None, "effort", "flow")]
    assert kinds == ["effort", "effort", "flow"]
    assert law("cube_of_force", ("force", "N"), at="flow", k=2.0).kind == "flow"


@pytest.mark.parametrize(
    ("name", "parameters", "value"),
    [
        ("modulus_of_velocity", {"k": -40.0}, -8.0),
        ("signed_square_of_position", {"k": 2.0}, 0.18),
        ("shifted_cube_of_position", {"k": 2.0, "c": 1.3}, -2.0),
        ("root_of_position", {"k": 4.0, "s": 0.1}, 0.6),
        ("above_of_position", {"k": 2.0, "c": 0.1}, 0.4),
        ("below_of_position", {"k": 2.0, "c": 0.1}, 0.0),
        ("below_of_position", {"k": 2.0, "c": 0.5}, -0.4),
        ("beyond_gap_of_position", {"k": 2.0, "s": 0.1}, 0.4),
        ("beyond_gap_of_position", {"k": 2.0, "s": 0.4}, 0.0),
        ("square_beyond_gap_of_velocity", {"k": 2.0, "s": 0.1}, 0.06),
        ("power_above_of_position", {"k": 2.0, "c": 0.1, "n": 3.0, "s": 0.1}, 16.0),
        ("power_above_of_position", {"k": 2.0, "c": 0.4, "n": 3.0, "s": 0.1}, 0.0),
        ("power_below_of_position_times_velocity", {"k": 2.0, "c": 0.5, "n": 2.0, "s": 0.1}, 1.6),
        ("inverse_power_of_position", {"k": 2.0, "c": 0.5, "n": 2.0, "s": 0.4}, 8.0),
        ("inverse_power_of_position_times_velocity", {"k": 2.0, "c": -0.1, "n": 3.0, "s": 0.2}, 0.05),
        ("power_of_position", {"k": 2.0, "n": 3.0, "s": 0.1}, 54.0),
        ("power_of_velocity", {"k": 2.0, "n": 0.5, "s": 0.05}, 4.0),
        ("even_power_of_position", {"k": 2.0, "n": 2.0, "s": 0.1}, 18.0),
        ("even_power_of_position_times_velocity", {"k": 2.0, "n": 1.5, "s": 0.3}, 0.4),
        ("peak_of_velocity", {"k": 3.0, "s": 0.2}, 3.0),
        ("stribeck_of_velocity", {"k": 2.0, "s": 0.2}, 2 * math.exp(-1)),
        ("bump_of_position", {"k": 2.0, "c": 0.1, "s": 0.2}, 2 * math.exp(-1)),
        ("step_of_time", {"k": 2.0, "c": 1.5, "s": 0.1}, 1.0),
        ("sine_of_position", {"k_s": 2.0, "k_c": 1.0, "T": 1.2}, 2.0),
        ("exponential_of_recent_speed_times_sign_of_velocity", {"k": 2.0, "s": 0.25}, 2 * (1 - math.exp(-1))),
        ("modulus_of_load_times_sign_of_velocity", {"k": 0.1}, 0.3),
        ("proportional_of_position_times_velocity", {"k": 2.0}, 0.12),
        ("bump_of_position_times_acceleration", {"k": 2.0, "c": 0.3, "s": 1.0}, 1.4),
        ("square_of_position_times_acceleration", {"k": 2.0}, 0.126 + 0.5 * 1.2 * 0.2**2),
        ("modulus_of_force_times_sign_of_velocity", {"k": 0.1}, 0.4),
        ("cube_of_bristle_deflection", {"k": 64.0}, 1.0),
    ],
)
def test_a_law_is_what_its_equation_says(name, parameters, value, value_at):
    effect = effect_named(name, [FORCE])
    assert value_at(effect, **parameters) == pytest.approx(value, rel=1e-4, abs=1e-9)


def test_every_shape_has_an_equation_of_its_own_and_is_used_somewhere():
    assert len({shape.equation for shape in SHAPES}) == len(SHAPES)
    assert all(shape.suits for shape in SHAPES)
    assert {effect.id for effect in EVERY} >= set(FORMS)
    assert set(FORMS.values()) <= {effect.id for effect in EFFECTS}


@pytest.mark.parametrize("name", ["power_of_velocity", "even_power_of_velocity"])
def test_a_power_of_the_velocity_is_rounded_as_narrowly_as_its_sign(bench, name):
    """A narrower epsilon makes it exact: what the rounding hides near zero would pass for dry friction."""
    effect, truth = bench(effect_named(name), k=2.0, n=0.45, s=20.0), 2.0 * (2e-3 / 20.0) ** 0.45
    wide, narrow = (effect.law(velocity=2e-3, epsilon=epsilon) for epsilon in (2e-2, 1e-4))
    assert narrow == pytest.approx(truth, rel=1e-3)
    assert abs(wide / truth - 1) > 0.2


def test_units_follow_from_the_port(make_model):
    port = make_model().plant.port("carriage")
    units = {
        name: [p.at(port).unit for p in effect_named(name, [FORCE]).parameters]
        for name in ("modulus_of_velocity", "square_of_load_times_sign_of_velocity", "cube_of_force")
    }
    assert units == {
        "modulus_of_velocity": ["N·s/m"],
        "square_of_load_times_sign_of_velocity": ["1/N"],
        "cube_of_force": ["1/N²"],
    }


def test_a_power_keeps_its_reference_and_its_amplitude_is_an_effort(make_model):
    port = make_model().plant.port("carriage")
    k, n, s = law("power_of_velocity", k=2.0, n=0.7, s=0.1).parameters
    assert [p.at(port).unit for p in (k, n, s)] == ["N", "1", "m/s"]
    assert [(p.guess, p.fixed) for p in (k, n, s)] == [(2.0, False), (0.7, False), (0.1, True)]
    assert (n.lower, n.upper) == EXPONENTS


def test_a_file_names_its_law_and_where_it_starts():
    effect = law("bump_of_position", k=3.0, c=-0.2, s=0.05)
    assert [(p.name, p.guess, p.absolute) for p in effect.parameters] == [
        ("k", 3.0, True), ("c", -0.2, True), ("s", 0.05, True)
    ]  # fmt: skip
    follows = law("modulus_of_force", over=("force", "N"), k=0.1)
    assert follows.channels == ("force",)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("modulus_of_velocty", {}), "'modulus_of_velocty' is the id of no composed law"),
        (("modulus_of_velocity", {"s": 1.0}), r"law modulus_of_velocity: unknown parameter 's'.*allowed: k"),
    ],
)
def test_a_wrong_law_is_one_line(words, said):
    name, guesses = words
    with pytest.raises(ValueError, match=said):
        law(name, **guesses)


def test_a_variable_with_memory_brings_its_state():
    for over in OVERS:
        effect = composed(over, shapes_over(over.variable)[0])
        assert bool(effect.states) == (over.variable in MEMORIES)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.name)
def test_another_process_gets_the_same_shape(shape):
    """A trace hands shapes to its workers; their functions are lambdas."""
    assert pickle.loads(pickle.dumps(shape)) is shape


@pytest.mark.parametrize(
    ("factor", "equation"),
    [
        ("", "F = k_s sin(2π q/T) + k_c cos(2π q/T)"),
        ("velocity", "F = (k_s sin(2π q/T) + k_c cos(2π q/T)) v"),
    ],
)
def test_a_factor_stands_behind_the_whole_sum(factor, equation):
    assert composed(Over("position", factor), shape_named("sine")).equation == equation
