"""Plants and effects of the user's own that are wrong in one place: the answer names the plant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from benchmarks.torture.case import BORNE, REFUSED, Case
from benchmarks.torture.lab import PLANT, fit

EFFECT = """
from hybridid.effects.effect import Dimension, Effect, EffectParameter
def law(at):
    return at.p.k * at.position
CABLE = Effect(
    id="cable", kind="effort", title="a cable", equation="F = k q", law=law,
    parameters=(EffectParameter("k", Dimension(effort=1, position=-1), "stiffness", nests=True),),
    source="a test", pattern="grows with the angle",
)
"""
BODY = 'return {"q": x.w, "w": (u.torque - p.G * ca.sin(x.q) - effort["pivot"]) / p.J}'
MOTION = 'return {"pivot": Motion(position=x.q, velocity=x.w)}'
OUTPUT = 'return {"angle": x.q}'
IMPORT = "import casadi as ca"
PARAMETERS = 'parameters = (Parameter("J", "kg·m²", 0.05, 0.001, 1.0), Parameter("G", "N·m", 2.0, 0.0, 10.0))'
PORT = 'Port("pivot", "effort", "N·m", 0.1, "rad", 1.0, 3.0, 0.01)'
G = 'Parameter("G", "N·m", 2.0, 0.0, 10.0)'
LAW = "return at.p.k * at.position"
ONE = 'parameters=(EffectParameter("k", Dimension(effort=1, position=-1), "stiffness", nests=True),)'

Changes = Mapping[str, tuple[str, str]]
"""What stands in the file, and what stands there instead, by what is wrong then."""

PLANTS: Changes = {
    "a wrong key": (BODY, "{}['q']\n        " + BODY),
    "a parameter misspelt": (BODY, BODY.replace("p.G", "p.K")),
    "a state misspelt": (BODY, BODY.replace("x.w", "x.v")),
    "an input misspelt": (BODY, BODY.replace("u.torque", "u.force")),
    "a port misspelt": (BODY, BODY.replace('effort["pivot"]', 'effort["pivto"]')),
    "a derivative that lacks a state": (BODY, 'return {"q": x.w}'),
    "a derivative of no state": (BODY, BODY.replace('{"q"', '{"zz": 0, "q"')),
    "a derivative that returns nothing": (BODY, "pass"),
    "a derivative that returns a list": (BODY, "return [x.w, x.w]"),
    "a derivative of text": (BODY, 'return {"q": "a", "w": "b"}'),
    "math.sin": (BODY, "import math\n        " + BODY.replace("ca.sin", "math.sin")),
    "if on a symbol": (BODY, "if x.q > 0: return {'q': x.w, 'w': x.w}\n        " + BODY),
    "a division by zero": (BODY, "1 / 0\n        " + BODY),
    "sys.exit(0)": (BODY, "import sys; sys.exit(0)\n        " + BODY),
    "sys.exit()": (BODY, "import sys; sys.exit()\n        " + BODY),
    "sys.exit('bye')": (BODY, "import sys; sys.exit('bye')\n        " + BODY),
    "sys.exit(0) at import": (IMPORT, f"import sys; sys.exit(0)\n{IMPORT}"),
    "SystemExit at import": (IMPORT, f"raise SystemExit\n{IMPORT}"),
    "GeneratorExit": (BODY, "raise GeneratorExit\n        " + BODY),
    "endless recursion": (BODY, "return self.derivative(x, u, p, effort)"),
    "an assertion": (BODY, "assert False\n        " + BODY),
    "an error of three lines": (BODY, "raise ValueError('a\\nb\\nc')\n        " + BODY),
    "an error of 100,000 characters": (BODY, "raise ValueError('a' * 100000)\n        " + BODY),
    "an error without words": (BODY, "raise ValueError()\n        " + BODY),
    "no memory": (BODY, "raise MemoryError\n        " + BODY),
    "a syntax error": (BODY, "return {"),
    "a wrong indent": (BODY, "   return 3"),
    "no such library": (IMPORT, "import nothere"),
    "no such name in a library": (IMPORT, "from casadi import nothere as ca"),
    "an unknown name": (IMPORT, f"{IMPORT}\nfoo"),
    "a constructor with arguments": ("def motion", "def __init__(self, a): pass\n\n    def motion"),
    "a constructor that fails": (
        "def motion",
        "def __init__(self): raise RuntimeError('a')\n\n    def motion",
    ),
    "no states": ("states = (", "stats = ("),
    "no outputs": ('outputs = (Signal("angle", "rad"),)', ""),
    "an output without its comma": (
        'outputs = (Signal("angle", "rad"),)',
        'outputs = (Signal("angle", "rad"))',
    ),
    "no inputs": ('inputs = (Signal("torque", "N·m"),)', ""),
    "inputs ()": ('inputs = (Signal("torque", "N·m"),)', "inputs = ()"),
    "no parameters": (PARAMETERS, ""),
    "no ports": (f"ports = ({PORT},)", ""),
    "ports ()": (f"ports = ({PORT},)", "ports = ()"),
    "no motion": ("def motion", "def mtion"),
    "no output": ("def output", "def outpt"),
    "a motion that lacks a port": (MOTION, "return {}"),
    "a motion that returns nothing": (MOTION, "pass"),
    "a motion of tuples": (MOTION, 'return {"pivot": (x.q, x.w)}'),
    "an output that returns nothing": (OUTPUT, "pass"),
    "an output misspelt": (OUTPUT, 'return {"angl": x.q}'),
    "an output that is a vector": (OUTPUT, 'return {"angle": ca.vertcat(x.q, x.q)}'),
    "a derivative that is a vector": (BODY, BODY.replace('"q": x.w', '"q": ca.vertcat(x.w, x.w)')),
    "a symbol of another kind": (BODY, "y = ca.MX.sym('y')\n        " + BODY.replace("u.torque", "y")),
    "a symbol of its own": (BODY, "y = ca.SX.sym('y')\n        " + BODY.replace("u.torque", "y")),
    "a state that an unknown output observes": ('"angle", derivative=1', '"angel", derivative=1'),
    "a scale of 0": ("scale=3.0", "scale=0.0"),
    "a scale that is no number": ("scale=3.0", 'scale=float("nan")'),
    "a state twice": ('State("w", "rad/s"', 'State("q", "rad/s"'),
    "a parameter twice": ('Parameter("G"', 'Parameter("J"'),
    "a guess that is text": (G, G.replace("2.0", '"2"')),
    "a guess that is no number": (G, G.replace("2.0", 'float("nan")')),
    "bounds the wrong way round": (G, G.replace("0.0, 10.0", "5.0, 1.0")),
    "an unknown kind of port": ('Port("pivot", "effort"', 'Port("pivot", "efort"'),
    "a port without its numbers": (PORT, 'Port("pivot")'),
    "an epsilon of 0": (PORT, PORT.replace("0.01", "0.0")),
    "no plant": ("class Pendulum(Plant):", "class Pendulum:"),
}
"""Plants that cannot be: the answer names the plant."""

ODD_PLANTS: Changes = {
    "a derivative of numbers": (BODY, 'return {"q": 1.0, "w": 2.0}'),
    "numpy's sin": (BODY, "import numpy as np\n        " + BODY.replace("ca.sin", "np.sin")),
    "an output that is no number": (OUTPUT, 'return {"angle": x.q * float("nan")}'),
    "an output that is constant": (OUTPUT, 'return {"angle": 1.0}'),
    "a derivative that is no number": (BODY, BODY.replace("u.torque", "float('nan')")),
    "a seventh derivative": ("derivative=1", "derivative=7"),
    "parameters ()": (PARAMETERS, "parameters = ()"),
    "a parameter of two words": ('Parameter("G"', 'Parameter("G h"'),
    "a port's scale of 0": (PORT, PORT.replace("0.1,", "0.0,")),
    "no name": ('name, meaning, source = "pendulum", "a pendulum on a motor shaft", "a test"', "pass"),
    "much that is printed": (BODY, "print('hello' * 1000)\n        " + BODY),
}

EFFECTS: Changes = {
    "a wrong key": (LAW, "{}['x']\n    " + LAW),
    "a parameter misspelt": (LAW, "return at.p.kk"),
    "what it sees misspelt": (LAW, "return at.positon"),
    "sys.exit(0)": (LAW, "import sys; sys.exit(0)"),
    "a law that returns nothing": (LAW, "pass"),
    "a law of text": (LAW, "return 'a'"),
    "a law that is a vector": (LAW, "import casadi as ca; return ca.vertcat(at.position, at.position)"),
    "no law": ("law=law", "law=3"),
    "nothing that nests": (", nests=True", ""),
    "no parameters": (ONE, "parameters=()"),
    "an unknown kind": ('kind="effort"', 'kind="efort"'),
    "no source": ('source="a test", ', ""),
    "an unknown argument": ('source="a test", ', 'source="a test", foo=3, '),
    "no effect": ("CABLE = Effect(", "CABLE = dict("),
}
ODD_EFFECTS: Changes = {
    "a law of a number": (LAW, "return 0.0"),
    "a law that is no number": (LAW, "return at.position * float('nan')"),
    "the acceleration squared": (LAW, "return at.p.k * at.acceleration**2"),
}
CABLE = "effects=[viscous,'cable:CABLE']"


def cases() -> Iterator[tuple[str, Case]]:
    """Each with its category."""
    for table, codes, says in ((PLANTS, REFUSED, ("pendulum",)), (ODD_PLANTS, BORNE, ())):
        for name, (old, new) in table.items():
            file = {"lab/case/pendulum.py": _changed(PLANT, old, new)}
            yield "own plants", Case(f"plant with {name}", tuple(fit()), says, codes, file)
    for table, codes, says in ((EFFECTS, REFUSED, ("cable",)), (ODD_EFFECTS, BORNE, ())):
        for name, (old, new) in table.items():
            file = {"lab/cable.py": _changed(EFFECT, old, new)}
            yield "own effects", Case(f"effect with {name}", tuple(fit(CABLE)), says, codes, file)
    yield from _under_other_commands()


def _under_other_commands() -> Iterator[tuple[str, Case]]:
    plant = {"lab/case/pendulum.py": _changed(PLANT, *PLANTS["a wrong key"])}
    says = ("pendulum.py", "line", "derivative")
    for command, *more in (("trace",), ("residual", "residual=rbf"), ("validate",), ("run",)):
        words = tuple(fit(*more, command=command))
        yield "own plants", Case(f"{command} of a plant with a wrong key", words, says, REFUSED, plant)
    tried = ("trace.effects=[cubic_stiffness]", "trace.extra_effects=[cable:CABLE]", "trace.processes=1")
    for name in ("a wrong key", "sys.exit(0)"):
        file = {"lab/cable.py": _changed(EFFECT, *EFFECTS[name])}
        words = tuple(fit(*tried, command="trace"))
        yield "own effects", Case(f"trace with an effect with {name}", words, ("cable.py",), REFUSED, file)


def _changed(text: str, old: str, new: str) -> str:
    assert old in text, old
    return text.replace(old, new)
