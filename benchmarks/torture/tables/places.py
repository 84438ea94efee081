"""Folders and files that are not what a command takes them for, and model files that hold no model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from benchmarks.torture.case import BORNE, REFUSED, Case, Content
from benchmarks.torture.lab import FOLDER, OWN, fit

LAB = ("fit", "--config-dir", "lab", "case=mine", "mlflow.enabled=false")


OUT: Mapping[str, tuple[str, Mapping[str, Content]]] = {
    "is a file": ("out=tree", {"tree": "x"}),
    "lies below a file": ("out=tree/a/b", {"tree": "x"}),
    "is empty": ("out=''", {}),
    "has 300 characters": ("out=" + "x" * 300, {}),
    "is in /proc": ("out=/proc/x", {}),
    "is a device": ("out=/dev/null", {}),
    "is a full device": ("out=/dev/full", {}),
    "is below outputs that are a file": ("paths.outputs=o", {"o": "x"}),
    "is below no outputs": ("paths.outputs=null", {}),
}
IN_THE_TREE: Mapping[str, tuple[Mapping[str, Content], tuple[int, ...]]] = {
    "config.yaml is a folder": ({"tree/config.yaml": FOLDER}, REFUSED),
    "the lock is a folder": ({"tree/.lock": FOLDER}, REFUSED),
    "fit is a file": ({"tree/fit": "x"}, BORNE),
    "preprocess is a file": ({"tree/preprocess": "x"}, BORNE),
    "receipts are no JSON": (
        {"tree/fit/receipt.json": "garbage", "tree/preprocess/receipt.json": "garbage"},
        (0,),
    ),
    "records are no JSON": ({"tree/preprocess/records.json": "garbage"}, (0,)),
    "fit has another's files": ({"tree/fit/estimate.json": "[]", "tree/fit/notes.txt": "mine"}, BORNE),
}
MODELS: Mapping[str, str] = {
    "nothing": "",
    "no JSON": "garbage",
    "a list": "[]",
    "null": "null",
    "an empty object": "{}",
    "a number": "3",
    "50,000 lists in each other": "[" * 50_000,
    "a plant that is no number": '{"plant": NaN}',
    "wrong types": '{"plant": 3, "effects": 4, "parameters": "x"}',
    "a model of another version": '{"case": "mine", "plant": "pendulum:Pendulum", "effects": [1, 2]}',
}


def cases() -> Iterator[tuple[str, Case]]:
    """Each with its category."""
    for name, (word, files) in OUT.items():
        yield _case(f"out {name}", (*LAB, word), REFUSED, files)
    for name, (files, codes) in IN_THE_TREE.items():
        yield _case(f"run folder: {name}", (*LAB, "out=tree"), codes, files)
    for name, text in MODELS.items():
        yield _case(f"model.json holds {name}", tuple(fit("model=m.json")), REFUSED, {"m.json": text})
    for name in ("lab/swing.csv", "nolab", ""):
        words = ("fit", "--config-dir", name, "case=mine", "mlflow.enabled=false")
        yield _case(f"--config-dir {name!r}", words, REFUSED, {})
    yield _case("records in a file", (*LAB, "out=tree", "paths.data=lab/swing.csv"), REFUSED, {})
    yield _case("out with a backslash", (*LAB, 'out="a\\0b"'), BORNE, {})
    yield _case("out of odd letters", (*LAB, 'out="my tree ü"'), (0,), {})
    yield _case("no outputs", (*LAB, "paths.outputs=''"), BORNE, {})
    yield _case("a case beside it is a folder", ("fit", *OWN), (0,), {"lab/case/other.yaml": FOLDER})


def _case(
    name: str, words: tuple[str, ...], codes: tuple[int, ...], files: Mapping[str, Content]
) -> tuple[str, Case]:
    return "files and folders", Case(name, words, (), codes, files)
