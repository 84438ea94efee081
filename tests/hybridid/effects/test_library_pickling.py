"""Effects and models travel to worker processes, those of a user's own file too."""

from __future__ import annotations

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import pytest

from hybridid.effects.effect import Effect, EffectParameter, Local
from hybridid.effects.friction import DRAG, VISCOUS
from hybridid.effects.library import EFFECTS, effect_named
from hybridid.effects.pickling import EffectNotSendable
from hybridid.model import Model, compose
from hybridid.plants.emps import EMPS

USERS_FILE = """
from dataclasses import replace
from hybridid.effects.effect import Effect, EffectParameter
from hybridid.effects.dimension import EFFORT
from hybridid.effects.friction import VISCOUS

EDDY = Effect(
    id="eddy", kind="effort", title="eddy brake", equation="F = b v/(1 + v²)",
    law=lambda at: at.p.b * at.velocity / (1 + at.velocity**2),
    parameters=(EffectParameter("b", EFFORT, "braking", nests=True),),
    source="a user", pattern="falls with speed",
)
GREASE = replace(VISCOUS, id="grease")
"""


def acceleration(model: Model) -> list[float]:
    """What a worker computes: x' of a model sent to it, at one point."""
    x = [0.1] * len(model.states)
    return [float(value) for value in model.f(0.5, x, [20.0], model.values()).elements()]


@pytest.fixture
def users(tmp_path, monkeypatch):
    """A user's file of effects on the import path."""
    (tmp_path / "my_effects_of_test_pickling.py").write_text(USERS_FILE)
    monkeypatch.syspath_prepend(str(tmp_path))
    return "my_effects_of_test_pickling"


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.id)
def test_an_effect_of_the_library_comes_back_as_itself(effect):
    assert pickle.loads(pickle.dumps(effect)) is effect
    assert copy.deepcopy(effect) is effect


def test_a_users_effects_come_back_as_themselves(users):
    for name in ("EDDY", "GREASE"):
        effect = effect_named(f"{users}:{name}")
        assert pickle.loads(pickle.dumps(effect)) is effect


def test_models_work_in_another_process(users):
    """Spawned, as on every platform: nothing is inherited but the import path."""
    names = ["viscous", "lugre", "input_delay", "sensor_lag", f"{users}:EDDY", f"{users}:GREASE"]
    model = compose(EMPS(), names)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        assert pool.submit(acceleration, model).result(timeout=60) == acceleration(model)


def _thick(at: Local):
    return at.p.c * at.velocity**3


def _made(law) -> Effect:
    parameters = (EffectParameter("c", DRAG, "drag", nests=True),)
    return Effect("thick", "effort", "thick", "F = c v³", law, "a test", "none", parameters)


def test_an_effect_made_on_the_way_travels_if_its_law_has_a_name():
    effect = _made(_thick)
    back = pickle.loads(pickle.dumps(effect))
    assert back == effect
    assert back is not effect


@pytest.mark.parametrize("law", [lambda at: at.p.c, type("Closure", (), {"law": lambda at: at.p.c}).law])
def test_an_effect_that_no_process_could_find_says_so(law):
    with pytest.raises(
        EffectNotSendable, match=r"effect thick .* write NAME = Effect\(\.\.\.\) at the top of a module"
    ):
        pickle.dumps(_made(law))


def test_a_changed_copy_is_not_mistaken_for_its_original():
    changed = replace(VISCOUS, title="another")
    with pytest.raises(EffectNotSendable, match="effect viscous"):
        pickle.dumps(changed)
