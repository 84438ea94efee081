"""A constant that was declared as known, and is wrong, is told. All records here are simulated."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.declarations import Parameter
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.trace.cautions import constants
from hybridid.trace.cautions.constants import Freed, WrongConstants, constants_in_words
from hybridid.trace.run import trace

DECLARED = ("viscous", "coulomb", "offset")


@pytest.fixture(scope="module")
def record(carriage, noise):
    """Five seconds of a carriage of 95 kg, on which a constant force of -3.2 N acts."""
    return carriage.record(2500, 0.002, noise(2500, 1e-5, seed=3))


@pytest.fixture(scope="module")
def traced(record):
    def of(mass, declared, effects):
        model = compose(EMPS(), declared, {"M": {"fixed": mass}})
        return trace(model, [record], effects=effects, laws=False, pairs=0, variables=("velocity",))

    return of


def test_in_the_place_of_a_name_a_wrong_mass_explains_as_much(traced):
    found = traced(80.0, DECLARED, ["added_inertia"])
    assert [one.effect for one in found.accepted] == ["added_inertia"]
    told = "in the place of carriage.added_inertia a constant that is declared as known explains as much"
    (caution,) = [one for one in found.cautions if told in one]
    assert caution.startswith("Beware: ")
    assert caution not in found.sentence
    said = caution.partition(", if it has another value: M = ")[2]
    assert float(said.split()[0]) == pytest.approx(95.0, abs=0.5)
    assert float(said.partition("To go on with that instead: parameters.M.fixed=")[2][:-1]) == pytest.approx(
        95.0, abs=0.5
    )
    assert found.verdict == "ambiguous"


def test_what_takes_the_place_of_all_is_not_told_of_each():
    """A wrong radius passes for gravity and a gain together."""
    values = SimpleNamespace(values={"r": 0.065}, std={"r": 1e-6})
    both, one = (Freed(Parameter("r", "m", 0.06), place, values) for place in (("p.a", "p.b"), ("p.a",)))
    said = constants_in_words(WrongConstants((both, one)))
    assert said.startswith(
        " Beware: in the place of p.a and p.b a constant that is declared as known explains"
    )
    assert "r = 0.0650000 ± 2·10⁻⁶ m instead of 0.06" in said
    assert said.count("Beware") == 1
    assert constants_in_words(WrongConstants()) == ""
    better = constants_in_words(WrongConstants((replace(both, more=0.55),)))
    assert (
        "declared as known explains more (55.0 % less error), if it has another value: r"
        in better.replace("\N{NO-BREAK SPACE}", " ")
    )


def test_the_parameters_that_follow_a_constant_are_told_with_it():
    """A gain that passes for a wrong weight scales all that the drive moves."""
    free = [Parameter("J", "kg·m²", 1.0), Parameter("f_c", "N·m", 1.0), Parameter("q_0", "rad", 0.0)]
    final = SimpleNamespace(
        model=SimpleNamespace(free=free), values={"J": 1.3342, "f_c": 1.667, "q_0": 0.2501}
    )
    freed = SimpleNamespace(
        values={"G": 10.8, "J": 1.6, "f_c": 2.0, "q_0": 0.25},
        std={"G": 1e-3, "J": 1e-4, "f_c": 0.5, "q_0": 1e-3},
    )
    others = constants._others(freed, final)
    assert others == "J is 1.6 kg·m² instead of 1.334 kg·m²"
    told = constants_in_words(
        WrongConstants((Freed(Parameter("G", "N·m", 9.0), ("p.a",), freed, 0.0, others),))
    )
    assert "instead of 9; then J is 1.6 kg·m² instead of 1.334 kg·m². To go on with that instead: " in told
    assert told.endswith("parameters.G.fixed=10.8.")


def test_in_the_place_of_all_it_begins_where_it_ended_beside_some(monkeypatch):
    """The valley of a constant far from its value is long: what was found beside more effects is nearer."""
    begun = []

    def ended(model, split, starts, *_, **__):
        begun.extend(starts)
        return SimpleNamespace(std={})

    monkeypatch.setattr(constants, "refit", ended)
    model = compose(EMPS(), DECLARED)
    last = {p.name: p.guess for p in model.parameters}
    search = SimpleNamespace(
        final=SimpleNamespace(model=model, values=last, score=SimpleNamespace(loss=1.0), numerics=None),
        first=SimpleNamespace(values=last),
    )
    (mass,) = [p for p in model.parameters if p.name == "M"]
    known = SimpleNamespace(values={**last, "M": 87.0, "guide.gravity.G": 3.0})
    constants._freed(mass, ("carriage.viscous",), (known,), search, None)
    assert [one["M"] for one in begun] == [last["M"], last["M"], 87.0]
    assert all("guide.gravity.G" not in one for one in begun)


def test_what_no_effect_explains_a_wrong_mass_does(traced):
    found = traced(80.0, DECLARED, ["cogging"])
    assert found.verdict == "unexplained"
    _, told, said = found.words.partition("A constant that is declared as known may be wrong: M = ")
    assert told
    assert float(said.split()[0]) == pytest.approx(95.0, abs=0.5)
    assert "instead of 80" in said


def test_a_right_constant_is_not_told(traced):
    """No mass does what a constant force does."""
    found = traced(95.0, DECLARED[:2], ["offset"])
    assert [one.effect for one in found.accepted] == ["offset"]
    assert "declared as known" not in found.words
    assert np.isclose(found.accepted[0].parameters["offset"].value, -3.2, atol=0.2)
