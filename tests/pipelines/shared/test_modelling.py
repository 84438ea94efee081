"""From config to model and fit settings."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from hybridid.effects.library import effect_named
from pipelines.runner import wanted
from pipelines.shared.config import Settings, flat
from pipelines.shared.errors import ConfigError
from pipelines.shared.modelling import (
    adjustments,
    fit_settings,
    model_of,
    parameters_of,
    searched_model_of,
)


def test_adjustments_are_flattened():
    nested = {
        "M": {"lower": 30, "upper": None},
        "carriage": {"viscous": {"f_v": {"guess": 200}}, "epsilon": {"fixed": 1e-3}, "coulomb": None},
        "k": {"upper": None},
    }
    assert adjustments(nested) == {
        "M": {"lower": 30.0}, "carriage.viscous.f_v": {"guess": 200.0}, "carriage.epsilon": {"fixed": 1e-3}
    }  # fmt: skip


def test_dotted_names_are_as_good_as_nested_ones(settings):
    change = {"parameters": {"M": {"lower": 30}, "carriage.viscous": {"f_v.guess": 200}, "M.upper": 150}}
    assert parameters_of(settings(change)) == {
        "M": {"lower": 30, "upper": 150}, "carriage": {"viscous": {"f_v": {"guess": 200}}}
    }  # fmt: skip
    for wrong, line in (
        ({"M": 3, "M.upper": 4}, "M is given twice: 3 and"),
        ({"M.upper": 4, "M": 3}, "M is given twice: .* and 3"),
        ({"M.upper": 4, "M": {"upper": 5}}, r"M\.upper is given twice: 4 and 5"),
        (3, "parameters is 3: give names"),
    ):
        with pytest.raises(ConfigError, match=line):
            parameters_of(settings({"parameters": wrong}))


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"fixed": float("inf")}, "M.fixed is inf: must be finite"),
        ({"guess": float("-inf")}, "M.guess is -inf: must be finite"),
        ({"lower": float("nan")}, "M.lower is nan: must be a number"),
        ({"lower": True}, "M.lower is True: must be a number"),
        ({"fixed": False}, "M.fixed is false: bounds let it be estimated, parameters.M.lower or .upper"),
        ({"lower": 10**400}, "too large a number"),
    ],
)
def test_a_parameter_is_a_number(settings, given, line):
    with pytest.raises(ConfigError, match=line):
        model_of(settings({"parameters": {"M": given}}))


def test_adjustments_reach_the_model(settings):
    change = {
        "parameters": {"M": {"fixed": 95}, "carriage": {"viscous": {"f_v": {"lower": 100, "guess": 150}}}}
    }
    parameters = {p.name: p for p in model_of(settings(change)).parameters}
    assert parameters["M"].fixed
    assert parameters["M"].guess == 95.0
    assert (parameters["carriage.viscous.f_v"].lower, parameters["carriage.viscous.f_v"].guess) == (
        100.0,
        150.0,
    )


def test_entries_of_effects_that_are_not_selected_wait(settings):
    change = {"parameters": {"carriage": {"stribeck": {"v_s": {"guess": 0.01}}}}}
    assert "carriage.stribeck.v_s" not in {p.name for p in model_of(settings(change)).parameters}
    chosen = model_of(settings({**change, "effects": ["coulomb", "stribeck"]}))
    assert next(p for p in chosen.parameters if p.name == "carriage.stribeck.v_s").guess == 0.01


def test_effect_at_a_named_port_and_from_a_module(settings):
    entries = ["viscous@carriage", "hybridid.effects.friction:COULOMB@carriage"]
    assert [t.name for t in model_of(settings({"effects": entries})).terms] == [
        "carriage.viscous", "carriage.coulomb"
    ]  # fmt: skip


def test_whole_floats_are_integers(settings):
    assert fit_settings(settings({"estimator": {"horizon": 1e3, "continuation": [3, 1]}})).horizon == 1000
    assert fit_settings(settings({"estimator": {"horizon": None}})).horizon is None


@pytest.mark.parametrize(
    ("estimator", "line"),
    [
        ({"horzion": 3}, "did you mean 'horizon'"),
        ({"interval": None}, "estimator.interval is null"),
        ({"horizon": 1}, "at least 2"),
        ({"starts": True}, "estimator.starts is True: expected a whole number"),
        ({"continuation": [3, 2]}, "must end with 1"),
    ],
)
def test_wrong_estimator(settings, estimator, line):
    with pytest.raises(ConfigError, match=line):
        fit_settings(settings({"estimator": estimator}))


def test_module_that_fails_names_its_line(settings, monkeypatch):
    Path("broken_plant_of_a_test.py").write_text("import math\n\nPLANT = math.nothing\n")
    monkeypatch.syspath_prepend(str(Path.cwd()))
    with pytest.raises(ConfigError, match=r"broken_plant_of_a_test\.py, line 3: AttributeError"):
        model_of(settings({"plant": "broken_plant_of_a_test:PLANT"}))


@pytest.mark.parametrize(
    ("plant", "line"),
    [
        ("hybridid.plants.emps", "module:NAME"),
        ("hybridid.plants.emsp:EMPS", "No module named"),
        ("hybridid.plants.emps:EMSP", "did you mean 'EMPS'"),
        ("hybridid.plants.emps:Parameter", "Parameter"),
    ],
)
def test_wrong_plant(settings, plant, line):
    with pytest.raises(ConfigError, match=line):
        model_of(settings({"plant": plant}))


def test_flat():
    assert flat({"a": {"b": 1, "c": {}}, "d": [1]}) == {"a.b": 1, "a.c": {}, "d": [1]}


def test_unknown_key_names_the_nearest():
    with pytest.raises(ConfigError, match="did you mean 'effects'"):
        Settings("mine", {"efects": []})
    with pytest.raises(ConfigError, match=r"below validate.*did you mean 'horizon'"):
        Settings("mine", {"validate": {"horzon": 1}})
    with pytest.raises(ConfigError, match="lacks plant"):
        model_of(Settings("mine", {"case": {"title": "x"}}))


@pytest.mark.parametrize(
    ("command", "stages"),
    [
        ("preprocess", ["preprocess"]),
        ("fit", ["preprocess", "fit"]),
        ("residual", ["preprocess", "fit", "residual"]),
        ("validate", ["preprocess", "fit", "residual", "validate"]),
        ("plot", ["preprocess", "fit", "residual", "validate", "plot"]),
        ("run", ["preprocess", "fit", "residual", "validate", "plot"]),
    ],
)
def test_stages_of_a_command(command, stages):
    assert [stage.name for stage in wanted(command)] == stages


def test_a_search_keeps_what_is_fixed_of_an_effect_that_it_may_add(settings):
    """Guesses and bounds of such an effect are the library's."""
    given = settings({"parameters": {"carriage.stribeck": {"v_s.fixed": 0.02, "df_s.upper": 1.0}}})
    assert "carriage.stribeck.v_s" not in model_of(given).adjustments
    searched = searched_model_of(given)
    assert searched.parameters == model_of(given).parameters
    added = {p.name: p for p in searched.plus(effect_named("stribeck"), "carriage").parameters}
    known, open_ = added["carriage.stribeck.v_s"], added["carriage.stribeck.df_s"]
    assert (known.guess, known.fixed, open_.upper, open_.fixed) == (0.02, True, math.inf, False)
