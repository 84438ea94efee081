"""Case files that are wrong in one place, with recordings and with the rig in their place."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import yaml

from benchmarks.torture.case import BORNE, REFUSED, Case, Content
from benchmarks.torture.lab import CASE, FOLDER, OWN, fit

FILE = "lab/case/mine.yaml"
HEAD = "# @package _global_\n"
NAN, INF = float("nan"), float("inf")
TORQUE, ANGLE, TIME = "signals.inputs.torque", "signals.outputs.angle", "signals.time"

KEYS: Mapping[str, Sequence[Any]] = {
    f"{TORQUE}.hold": ("foo",),
    f"{TORQUE}.unit": (3, "V"),
    f"{TORQUE}.scale": (0, "big", NAN),
    f"{TORQUE}.sign": (2, 0.5),
    f"{TORQUE}.offset": (INF,),
    f"{TORQUE}.column": (3, None, "", [1]),
    f"{TORQUE}.scael": (1,),
    f"{TORQUE}.factor": (3, "nope"),
    TORQUE: (3, None),
    "signals.inputs": (None, [], {}, 3, "abc"),
    "signals.inputs.torqeu": ({"column": "torque", "unit": "N·m"},),
    f"{ANGLE}.unit": ("", "x" * 1000),
    "signals.outputs": (None, {}),
    "signals": (None, 3, [], {}),
    TIME: (3, {"dt": 0}, {"dt": -1}, {"rate": INF}, {"rate": "fast"}),
    f"{TIME}.unit": ("year",),
    f"{TIME}.same": (["zz"],),
    "signals.foo": (3,),
    "signals.resample": (-1, "x", True, 1e9),
    "records.swing": (None, 3),
    "records": (None, {}, [], "a.csv"),
    "records.swing.role": ("test", None),
    "records.swing.files": (None, 3, [], {"a": 1}),
    "records.swing.fiels": ("x",),
    "records.swing.steps": (3, "abc", [3], [{"step": "crop"}], {"step": "crop"}),
    "effects": (
        3,
        "viscous",
        [None],
        [[]],
        {"a": 1},
        ["viscous@"],
        ["@pivot"],
        [""],
        ["viscous@pivot@pivot"],
    ),
    "plant": (None, 3, [], "pendulum", ":", "os:system", "os:path", "sys:exit", "builtins:print"),
    "case": (3,),
    "case.foo": (1,),
    "preprocess": (3,),
    "preprocess.steps": (3,),
    "preprocess.foo": (1,),
    "channels": (["a"], 3, [3]),
    "fit": (3,),
    "fit.records": (["x"], [], 3),
    "foo": (1,),
    "defaults": (["nonsense"],),
}
"""Values that no case may have."""
ODD: Mapping[str, Sequence[Any]] = {
    TIME: (None, {}, {"dt": 1e-320}, {"dt": 1e300}),
    "signals.resample": (0, 1e-9, {"dt": 0.01, "method": "cubic"}),
    "records.swing.files": (["swing.csv", "swing.csv"],),
    "records.swing.run": (3,),
    "effects": (None,),
    "channels": (None,),
    "case": (None,),
    "case.title": (None, 3),
    "plant": ("hybridid.plants.emps:EMPS", "antigravity:x"),
    "preprocess": (None,),
    "preprocess.steps": (None, {}),
    "archive": (3, {"name": 3}),
    "rig": (3, []),
    "fit.records": ("swing",),
    "hydra": (3,),
}
"""Values that may be right."""
TEXTS: Mapping[str, Content] = {
    "an open bracket": f"{HEAD}{{{{{{",
    "a tab": f"{HEAD}case:\n\ttitle: x",
    "bytes of every value": bytes(range(256)),
    "nothing": "",
    "a list": f"{HEAD}- a\n- b",
    "a word": f"{HEAD}abc",
    "a tag of Python": f"{CASE}foo: !!python/object/apply:os.system ['true']\n",
    "a reference to nothing": CASE.replace("pendulum:Pendulum", "${nothing}"),
    "a reference to the environment": CASE.replace("pendulum:Pendulum", "${oc.env:NOTHERE}"),
    "a reference to itself": CASE.replace("pendulum:Pendulum", "${plant}"),
    "a value to be given": CASE.replace("pendulum:Pendulum", "???"),
    "a key twice": f"{CASE}plant: x:y\n",
    "no package": CASE.partition("\n")[2],
    "lists of lists of lists": CASE + "foo:\n - &a [x,x,x,x,x,x,x,x,x]\n - &b [*a,*a,*a,*a,*a,*a,*a,*a]\n"
    " - &c [*b,*b,*b,*b,*b,*b,*b]\n - &d [*c,*c,*c,*c,*c,*c,*c]\n",
}
RIG = {
    "plant": "hybridid.plants.emps:EMPS",
    "rig": {"path": "hybridid.rigs.emps:EMPSRig", "duration": 1.2},
    "signals.inputs": {"force": {"column": "torque", "unit": "N"}},
    "signals.outputs": {"position": {"column": "angle", "unit": "m"}},
    "records.swing.run": "identification",
}
"""What makes of the case one of a rig."""


def cases() -> Iterator[tuple[str, Case]]:
    """Each with its category."""
    for table, codes in ((KEYS, REFUSED), (ODD, BORNE)):
        for key, values in table.items():
            for value in values:
                said = f"{key} = {value!r}"[:100]
                yield "case files", Case(f"case: {said}", tuple(fit()), (), codes, case({key: value}))
                if key.startswith(("signals", "records", "channels")):
                    yield "case files of a rig", _of_the_rig(key, value, said, codes)
    for name, content in TEXTS.items():
        yield "case files", Case(f"case file with {name}", tuple(fit()), (), REFUSED, {FILE: content})
    words = ("fit", "--config-dir", "lab", "case=other")
    yield "case files", Case("a case that is a folder", words, files={"lab/case/other.yaml": FOLDER})


def case(changes: dict[str, Any]) -> dict[str, Content]:
    """The lab's case file with other values of some keys."""
    content = copy.deepcopy(yaml.safe_load(CASE))
    for key, value in copy.deepcopy(changes).items():
        *above, last = key.split(".")
        node = content
        for name in above:
            if not isinstance(node.get(name), dict):
                node[name] = {}
            node = node[name]
        node[last] = value
    return {FILE: HEAD + yaml.safe_dump(content, allow_unicode=True)}


def _of_the_rig(key: str, value: Any, said: str, codes: tuple[int, ...]) -> Case:
    """The checks of ``signals`` hold where a rig stands in for the recordings, too. Its records have no
    files, so what is said of files may be passed over."""
    theirs = key.replace("torque", "force").replace("angle", "position")
    words = ("fit", *OWN, "data=simulated")
    passed = key.startswith(("records.swing.f", "records.swing.s", TIME))
    passed = passed or key in ("signals.resample", f"{TORQUE}.factor")  # which is a column of a file
    codes = BORNE if passed else codes
    return Case(f"case of a rig: {said}", words, (), codes, case({**RIG, theirs: value}))
