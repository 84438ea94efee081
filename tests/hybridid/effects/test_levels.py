"""Levels: what each is at a point, which variables a law may have beside its own, and its name."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from hybridid.declarations import Signal
from hybridid.effects.composed import law
from hybridid.effects.levels import LEVELS, Level, levels_over, overs_of_level
from hybridid.effects.library import effect_named
from hybridid.effects.over import RECENT, Over
from hybridid.effects.shapes import SHAPES

FORCE = Signal("force", "N")
RIPPLE = Over("position")


@pytest.mark.parametrize(
    ("name", "parameters", "value"),
    [
        ("proportional_of_load_by_modulus_of_velocity", {"k": 2.0}, 1.2),
        ("sign_of_velocity_by_square_of_load", {"k": 2.0}, 18.0),
        ("sign_of_velocity_by_shifted_of_time", {"k": 2.0, "c_2": 0.5}, 2.0),
        ("sign_of_velocity_by_above_of_time", {"k": 2.0, "c_2": 2.0}, 0.0),
        ("sign_of_velocity_by_raised_modulus_of_force", {"k": 2.0, "s_2": 8.0}, 3.0),
        ("proportional_of_position_by_saturating_of_velocity", {"k": 2.0, "s_2": 0.2}, 0.6 * math.tanh(1)),
        ("proportional_of_position_by_peak_of_velocity", {"k": 2.0, "s_2": 0.2}, 0.6),
        ("proportional_of_position_by_gaussian_of_velocity", {"k": 2.0, "s_2": 0.2}, 0.6 * math.exp(-1)),
        ("sign_of_velocity_by_bump_of_position", {"k": 2.0, "c_2": 0.1, "s_2": 0.2}, 2 * math.exp(-1)),
        (
            "sign_of_velocity_by_raised_bump_of_position",
            {"k": 2.0, "c_2": 0.3, "s_2": 0.2, "h_2": -0.25},
            1.5,
        ),
        ("sign_of_velocity_by_step_of_time", {"k": 2.0, "c_2": 1.5, "s_2": 0.1}, 1.0),
        ("sign_of_velocity_by_raised_step_of_time", {"k": 2.0, "c_2": 1.5, "s_2": 0.1, "h_2": 1.0}, 3.0),
        ("sign_of_velocity_by_fading_of_time", {"k": 2.0, "s_2": 1.5}, 2 * math.exp(-1)),
        ("sign_of_velocity_by_raised_fading_of_recent_speed", {"k": 2.0, "s_2": 0.25, "h_2": math.e}, 4.0),
        (
            "bump_of_position_times_sign_of_velocity_by_modulus_of_load",
            {"k": 2.0, "c": 0.3, "s": 0.1},
            6.0,
        ),
    ],
)
def test_a_law_is_what_its_equation_says(name, parameters, value, value_at):
    assert value_at(effect_named(name, [FORCE]), **parameters) == pytest.approx(value, rel=1e-4, abs=1e-9)


def test_the_equation_has_both_factors():
    ripple = effect_named("sine_of_position_by_modulus_of_load")
    assert ripple.equation == "F = (k_s sin(2π q/T) + k_c cos(2π q/T)) |L|, L = drive - load"
    assert ripple.needs == ("load",)
    late = effect_named("sign_of_velocity_by_fading_of_recent_speed")
    assert late.equation == "F = k sign(v) exp(-r/s_2), tau r' = |v| - r"
    assert [state.name for state in late.states] == ["recent_speed"]


def test_units_follow_from_both_variables(make_model):
    port = make_model().plant.port("carriage")
    ripple = effect_named("sine_of_position_by_raised_step_of_time")
    assert [p.at(port).unit for p in ripple.parameters] == ["N", "N", "m", "s", "s", "1"]
    rubbing = effect_named("modulus_of_velocity_by_modulus_of_load")
    assert [p.at(port).unit for p in rubbing.parameters] == ["s/m"]


def test_a_level_depends_on_another_variable_with_one_memory_and_one_channel():
    def names(over):
        return {one.name for one in overs_of_level(over, "effort", [FORCE])}

    assert names(RIPPLE) == {"velocity", "time", "load", "recent speed", "recent load", "force"}
    assert names(Over(RECENT, "sign of velocity")) == {"velocity", "position", "time", "load", "force"}
    assert names(Over("input", "", FORCE)) == {
        "velocity", "position", "time", "load", "recent speed", "recent load"
    }  # fmt: skip
    assert names(Over("position", "acceleration")) == set()


def test_every_level_has_a_variable_and_no_amplitude_of_its_own():
    assert all(shape.suits and not shape.amplitudes for shape in LEVELS)
    assert len({shape.equation for shape in LEVELS}) == len(LEVELS)
    names = {shape.name for shape in SHAPES}
    assert all(set(shape.roles) <= {"c_2", "s_2", "h_2"} for shape in LEVELS)
    assert "proportional" in names  # a level may bear the name of a shape; both are found again
    level = next(shape for shape in LEVELS if shape.name == "proportional")
    assert pickle.loads(pickle.dumps(level)) is level


def test_a_level_along_a_path_is_its_function():
    level = Level(Over("time"), "raised_step")
    assert level.shape in levels_over(level.over)
    at = np.linspace(0.0, 2.0, 5)
    found = level.shape.values(at, {"c_2": 1.0, "s_2": 0.5, "h_2": 2.0})
    assert found == pytest.approx(1 + (1 + np.tanh((at - 1.0) / 0.5)))


def test_a_file_names_its_law_and_where_it_starts():
    effect = law("sign_of_velocity_by_modulus_of_force", over=("force", "N"), k=0.1)
    assert effect.channels == ("force",)
    assert effect.parameters[0].guess == 0.1
    with pytest.raises(ValueError, match="is the id of no composed law"):
        law("sign_of_velocity_by_modulus_of_velocity", k=0.1)
