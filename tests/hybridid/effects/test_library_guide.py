"""docs/effects.md: the effect that it adds works, and its advice on slow machines can be followed."""

from __future__ import annotations

import pickle
import re
from pathlib import Path

import numpy as np
import yaml

from hybridid.effects.library import EFFECTS, effect_named
from hybridid.model import compose
from hybridid.plants.emps import EMPS

GUIDE = (Path(__file__).parents[3] / "docs" / "effects.md").read_text()


def block(language: str) -> str:
    """The guide's only block in that language."""
    found = re.findall(rf"^( *)```{language}\n(.*?)^ *```", GUIDE, re.DOTALL | re.MULTILINE)
    assert len(found) == 1
    indent, text = found[0]
    return re.sub(f"^{indent}", "", text, flags=re.MULTILINE)


def test_the_effect_of_the_guide_works(tmp_path, monkeypatch):
    (tmp_path / "wear.py").write_text(block("python"))
    monkeypatch.syspath_prepend(str(tmp_path))
    effect = effect_named("wear:MID_STROKE_WEAR")
    assert pickle.loads(pickle.dumps(effect)) is effect
    model = compose(EMPS(), ["viscous", "wear:MID_STROKE_WEAR"])
    values = model.values({"carriage.mid_stroke_wear.df_c": 5.0, "carriage.mid_stroke_wear.q_0": 0.1})
    _, wear = np.asarray(model.efforts(0, [0.1, 0.2], [0.0], values)).ravel()
    assert wear == np.float64(5.0)
    assert set(effect.look_alikes) <= {e.id for e in EFFECTS}


def test_the_constants_for_slow_machines_are_accepted():
    groups = yaml.safe_load(block("yaml"))["parameters"]["force"]
    changes = {f"force.{id_}.{name}": c for id_, own in groups.items() for name, c in own.items()}
    model = compose(EMPS(), ["input_delay", "input_lag"], changes)
    at_20_hz = dict(zip([p.name for p in model.parameters], model.values(), strict=True))
    assert at_20_hz["force.input_delay.window"] == 0.5
    assert at_20_hz["force.input_lag.floor"] == 0.025
    assert {"force.input_delay.delay", "force.input_lag.T"} <= {p.name for p in model.free}


def test_every_effect_that_the_guide_names_exists():
    named = set(re.findall(r"\*\*([a-z]+(?:_[a-z]+)*)\*\*", GUIDE)) - {"increment"}
    assert {"backlash", "free_play", "gravity"} <= named
    assert named <= {e.id for e in EFFECTS}
