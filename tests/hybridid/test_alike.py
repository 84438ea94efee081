"""One effect at several ports with one set of parameters."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.model import Model, compose
from hybridid.plants.half_car import HalfCar
from hybridid.trace.candidates import admissible

BOTH = "front_suspension+rear_suspension"


@pytest.fixture(scope="module")
def both() -> Model:
    return compose(HalfCar(), [f"asymmetric_damper@{BOTH}"])


def rates(model: Model, **values: float) -> np.ndarray:
    x = np.linspace(0.01, 0.3, len(model.states))
    return np.asarray(model.f(0.0, x, [0.01, 0.02], model.values(values))).ravel()


def test_it_acts_as_two_effects_with_equal_parameters(both):
    own = [p.name for p in both.parameters if p.name.startswith(BOTH)]
    given = {name: 0.3 * (1 + k) * 1e3 for k, name in enumerate(own)}
    apart = compose(HalfCar(), [f"asymmetric_damper@{port}" for port in BOTH.split("+")])
    same = {f"{port}.{name.split('.', 1)[1]}": v for name, v in given.items() for port in BOTH.split("+")}
    assert rates(both, **given) == pytest.approx(rates(apart, **same))
    assert len(apart.free) == len(both.free) + len(own)
    assert rates(both, **given) != pytest.approx(rates(both))


def test_each_port_shows_its_own_effort(both):
    assert [(term.effect.id, port) for term, port in both.effort_places] == [
        ("asymmetric_damper", port) for port in BOTH.split("+")
    ]
    assert both.efforts.size1_out(0) == 2


def test_a_search_tries_each_port_alone_and_both_together():
    effect = effect_named("asymmetric_damper")
    bare = compose(HalfCar(), [])
    assert {c.port for c in admissible(bare, [effect])} >= {BOTH, *BOTH.split("+")}
    assert all("+" not in c.port for c in admissible(bare, [effect_named("dahl")])), "it has a state"
    assert [c.port for c in admissible(bare, [effect], ["front_suspension"])] == ["front_suspension"]
    present = compose(HalfCar(), ["asymmetric_damper@rear_suspension"])
    assert BOTH not in {c.port for c in admissible(present, [effect])}


@pytest.mark.parametrize(
    ("entry", "why"),
    [
        ("dahl@front_suspension+rear_suspension", "acts at one port"),
        ("viscous@front_suspension+rear", "rear"),
        ("input_gain@u_f+u_r", "effort or flow ports"),
    ],
)
def test_what_cannot_act_at_several_ports_is_one_line(entry, why):
    with pytest.raises(ValueError, match=why):
        compose(HalfCar(), [entry])
