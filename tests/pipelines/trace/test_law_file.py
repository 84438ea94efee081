"""A proposed law as a file: it imports, and is the law with its numbers."""

from __future__ import annotations

import math
import runpy
from dataclasses import replace
from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.trace.entries import Value, Width
from pipelines.trace.law_file import NAME, law_files


@pytest.fixture
def found(stored):
    """``found(law, ...)``: what ``law_files`` reads of a trace that proposes these laws on the EMPS."""
    (accepted,) = stored().found.accepted

    def make(*laws: str, **parameters: float):
        model = compose(EMPS(), ["viscous", *laws])
        signals = model.inputs
        entries = [
            replace(
                accepted,
                effect=name,
                port="carriage",
                is_law=True,
                equation=effect_named(name, signals).equation,
                parameters={key: Value(value, 0.1, "N") for key, value in parameters.items()},
            )
            for name in laws
        ]
        given = {"model": model, "provenance": "simulated", "narrowed": ()}
        return SimpleNamespace(accepted=(accepted, *entries), **given)

    return make


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("modulus_of_velocity", {"k": -36.948078}),
        ("bump_of_position_times_sign_of_velocity", {"k": 3.25, "c": 0.1, "s": 0.02}),
        ("modulus_of_force_times_sign_of_velocity", {"k": 0.031}),
    ],
)
def test_the_file_holds_the_law_with_its_numbers(found, tmp_path, name, parameters):
    ((file, text),) = law_files(found(name, **parameters), "emps").items()
    (tmp_path / file).write_text(text, encoding="utf-8")
    effect = runpy.run_path(str(tmp_path / file))[name.upper()]
    assert effect.id == name
    assert {p.name: p.guess for p in effect.parameters} == parameters
    assert "emps (simulated)" in text
    assert f"proposed_law:{name.upper()}@carriage" in text


def test_the_file_holds_the_constants_of_the_law(found):
    given = found("power_of_velocity", k=3.25, n=0.7)
    given.accepted = (replace(given.accepted[-1], known={"s": Value(0.05, math.nan, "m/s")}),)
    text = law_files(given, "emps")[NAME]
    assert "|^(n - 1), with s = 50 mm/s   at carriage" in text
    assert 'law("power_of_velocity", k=3.25, n=0.7, s=0.05)' in text


def test_the_file_says_how_sign_v_was_smoothed_if_a_trace_made_that_narrower(found):
    given = found("modulus_of_velocity", k=1.0)
    assert "smoothed" not in law_files(given, "emps")[NAME]
    given.narrowed = (Width("carriage.epsilon", "m/s", 1e-3, 2.5e-4),)
    assert "\n    parameters.carriage.epsilon.guess=0.00025\n" in law_files(given, "emps")[NAME]


def test_several_laws_have_a_file_each_and_names_none(found):
    files = law_files(found("modulus_of_velocity", "cube_of_position", k=1.0), "emps")
    assert list(files) == ["proposed_law_1.py", "proposed_law_2.py"]
    assert "[proposed_law_2:CUBE_OF_POSITION]" in files["proposed_law_2.py"]
    assert law_files(found(), "emps") == {}


def test_the_file_tells_a_flow_from_an_effort(found):
    """A law over an input has the same id at both kinds of port."""
    given = found("cube_of_force", k=1.0)
    (term,) = given.model.terms[1:]
    flow = replace(term, effect=effect_named("cube_of_force", given.model.inputs, at="flow"))
    given.model = SimpleNamespace(terms=(flow,), signals=given.model.signals)
    assert (
        'law("cube_of_force", over=("force", "N"), k=1)'
        in law_files(found("cube_of_force", k=1.0), "emps")[NAME]
    )
    assert 'law("cube_of_force", over=("force", "N"), at="flow", k=1)' in law_files(given, "emps")[NAME]
