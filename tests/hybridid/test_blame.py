"""What code of the user's own does wrong costs one line: file, line, function, and what is wrong."""

from __future__ import annotations

import importlib.util
import itertools
import sys
from pathlib import Path
from types import ModuleType

import pytest

from hybridid.blame import Named, OwnCodeError, blamed_on, imported
from hybridid.model import compose

COUNT = itertools.count()
PLANT = """
import casadi as ca
from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.effects.effect import Dimension, Effect, EffectParameter
from hybridid.plants.plant import Load, Motion, Plant

def helper(x):
    return {}["z"]

class Pendulum(Plant):
    name, meaning, source = "pendulum", "a pendulum", "a test"
    states = (State("q", "rad", observed_by="angle"), State("w", "rad/s", observed_by="angle", derivative=1))
    inputs = (Signal("torque", "N·m"),)
    outputs = (Signal("angle", "rad"),)
    parameters = (Parameter("J", "kg·m²", 0.05), Parameter("G", "N·m", 2.0))
    ports = (Port("pivot", "effort", "N·m", 0.1, "rad"),)

    def motion(self, x, u, p):
        return {"pivot": Motion(position=x.q, velocity=x.w)}

    def derivative(self, x, u, p, effort):
        return {"q": x.w, "w": (u.torque - p.G * ca.sin(x.q) - effort["pivot"]) / p.J}

    def output(self, x, u, p):
        return {"angle": x.q}

def law(at):
    return at.p.k * at.position

CABLE = Effect(
    id="cable", kind="effort", title="a cable", equation="F = k q", law=law, source="a test", pattern="p",
    parameters=(EffectParameter("k", Dimension(effort=1, position=-1), "stiffness", nests=True),),
)
"""
RATES = 'return {"q": x.w, "w": (u.torque - p.G * ca.sin(x.q) - effort["pivot"]) / p.J}'
LAW = "return at.p.k * at.position"
MOVES = 'return {"pivot": Motion(position=x.q, velocity=x.w)}'
SHOWS = 'return {"angle": x.q}'


def module_of(text: str, folder: Path) -> ModuleType:
    """``text`` as the module ``mine.py``, imported."""
    path = folder / "mine.py"
    path.write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location(f"mine_{next(COUNT)}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_good_code_makes_a_model(own_folder):
    module = module_of(PLANT, own_folder)
    assert compose(module.Pendulum(), [module.CABLE]).f.n_out() == 1


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (RATES, "return {}['q']", "mine.py, line 22, in derivative: KeyError: 'q'"),
        (RATES, "return helper(x)", "mine.py, line 8, in helper: KeyError: 'z'"),
        (RATES, RATES.replace("p.G", "p.g_"), "in derivative: AttributeError: unknown parameter 'g_'"),
        (RATES, "import sys; sys.exit(0)", "line 22, in derivative: it ends the program"),
        (RATES, "assert False", "line 22, in derivative: AssertionError: assert False"),
        (RATES, "raise ValueError('a\\n' * 9999)", "line 22, in derivative: ValueError: a a a"),
        (RATES, "return x.q if x.q > 0 else 0", "in derivative: RuntimeError: Cannot compute the truth"),
        (RATES, 'return {"q": x.w}', "line 21, derivative: gives nothing for state w"),
        (RATES, RATES.replace('{"q"', '{"v": 1, "q"'), "derivative: gives unknown state 'v': allowed: q, w"),
        (RATES, "pass", "derivative: gives nothing (None), expected a value for each state: q and w"),
        (RATES, RATES.replace("x.w,", "'a',", 1), "derivative: gives a str for state q"),
        (RATES, RATES.replace("x.w,", "[x.w, x.w],", 1), "derivative: gives a list for state q"),
        (RATES, RATES.replace("ca.sin", "__import__('math').sin"), "hold a NaN: math and numpy cannot take"),
        (RATES, RATES.replace("p.J", "ca.SX.sym('y')"), "mine.py, line 10: RuntimeError: f::init"),
        (MOVES, "return {}", "motion: gives nothing for port pivot"),
        (MOVES, 'return {"pivot": (x.q, x.w)}', "gives a tuple for port pivot, expected Motion"),
        ("def output", "def outptu", "plant pendulum has no method output, which gives angle"),
        (SHOWS, 'return {"angle": ca.vertcat(x.q, x.w)}', "gives 2 x 1 expressions for output angle"),
        (LAW, "return {}['x']", "mine.py, line 28, in law: KeyError: 'x'"),
        (LAW, "return at.p.stiff", "in law: AttributeError: unknown parameter 'stiff'"),
        (LAW, "pass", "law: gives nothing (None) for the law of effect cable"),
        ("outputs = (Signal(", "outputs_ = (Signal(", "plant pendulum: outputs is missing, expected a tuple"),
        ('outputs = (Signal("angle", "rad"),)', 'outputs = Signal("angle", "rad")', "outputs is a Signal"),
        ('Parameter("G"', 'Parameter("J"', "two of its parameters are called J"),
        ('Parameter("G"', 'Parameter("G h"', "'G h' among its parameters is no name"),
        ('observed_by="angle")', 'observed_by="angel")', "of state q: 'angel': did you mean 'angle'"),
        ('"pivot", "effort"', '"angle_sensor", "output"', "output, after which a port of that kind is named"),
    ],
)  # fmt: skip
def test_fault_is_named_with_its_place(old, new, said, own_folder):
    assert old in PLANT
    module = module_of(PLANT.replace(old, new), own_folder)
    with pytest.raises(OwnCodeError) as caught:
        _ = compose(module.Pendulum(), [module.CABLE]).f
    line = str(caught.value)
    assert said in line
    assert line.startswith("mine.py, line ")
    assert "\n" not in line
    assert len(line) < 400


def test_a_plant_whose_outputs_are_all_sensed_needs_no_output(own_folder):
    sensed = PLANT.replace("def output(self, x, u, p)", "def sensed(self, x, u, p, effort)")
    assert sensed != PLANT
    module = module_of(sensed, own_folder)
    assert compose(module.Pendulum(), [module.CABLE]).f.n_out() == 1


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"w", "rad/s"', '"w", "rad/s", scale=0.0', "state w: scale is 0, must be positive and finite"),
        ('"effort", "N·m", 0.1', '"efort", "N·m", 0.1', "unknown kind 'efort': did you mean 'effort'?"),
        ('"effort", "N·m", 0.1', '"effort", "N·m", 0.0', "port pivot: effort_scale is 0, must be positive"),
        ("law=law", "law=3", "effect cable: law is 3, expected a function"),
        ('kind="effort"', 'kind="force"', "effect cable: unknown kind 'force'"),
    ],
)
def test_wrong_declaration_is_refused_as_it_is_made(old, new, said, own_folder):
    with pytest.raises(ValueError, match=r"must be|unknown|expected") as caught:
        module_of(PLANT.replace(old, new), own_folder)
    assert said in str(caught.value)


def test_import_that_fails_names_the_line(own_folder, monkeypatch):
    monkeypatch.syspath_prepend(own_folder)
    for name, text, said in (
        ("mine_a", "x = 1\n1 / 0\n", "mine_a fails when imported: mine_a.py, line 2: ZeroDivisionError"),
        ("mine_b", "import sys\nsys.exit(0)\n", "mine_b.py, line 2: it ends the program"),
        ("mine_c", "x = {\n", "mine_c.py, line 1: SyntaxError: '{' was never closed"),
        ("mine_d", "\nimport no_such_module\n", "mine_d.py, line 2: No module named 'no_such_module'"),
        ("mine_e", "X = 1\n", "unknown name in mine_e 'Y': allowed: X"),
        (
            "mine_i",
            "import os\nfrom pathlib import Path\nclass Z: pass\nX = 1\n",
            "unknown name in mine_i 'Y': allowed: Z, X",
        ),
    ):
        (own_folder / f"{name}.py").write_text(text)
        with pytest.raises(ValueError, match="plant mine_") as caught:
            imported(f"{name}:Y", "plant")
        assert said in str(caught.value)


@pytest.mark.parametrize("path", ["", ":", "a", "a:", ":b", "../x:y", "a b:c"])
def test_malformed_path_is_refused(path):
    with pytest.raises(ValueError, match="give an import path, module:NAME"):
        imported(path, "plant")


def test_what_hybridid_raises_itself_passes():
    with pytest.raises(LookupError), blamed_on(None, passing=(LookupError,)):
        raise LookupError


def test_names_answer_with_the_nearest():
    values = Named("state", {"q": 1, "what": 2})
    assert values.q == 1
    assert vars(values) == {"q": 1, "what": 2}
    with pytest.raises(AttributeError, match="unknown state 'wat': did you mean 'what'"):
        _ = values.wat
