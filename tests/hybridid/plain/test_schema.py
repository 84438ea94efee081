"""The schema of a result allows what ``plain`` writes of it, and nothing else."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from jsonschema import Draft202012Validator, ValidationError
from numpy.typing import NDArray

from hybridid.plain import plain, schema


@dataclass(frozen=True)
class About:
    """What it is about."""

    case: str


@dataclass(frozen=True)
class Mass:
    """A mass."""

    name: str
    value: float = field(metadata={"meaning": "moved mass", "unit": "kg"})


@dataclass(frozen=True, eq=False)
class Result:
    """One result."""

    about: About = field(metadata={"inline": True})
    masses: tuple[Mass, ...] = field(metadata={"by": "name"})
    rows: tuple[Mass, ...]
    best: Mass | None
    matrix: NDArray[np.float64]
    kind: Literal["low", "high"]
    pair: tuple[str, int]
    seconds: Mapping[str, float]
    alike: tuple[str, ...] = field(metadata={"key": "class"})
    horizon: float | None
    count: int | None
    file: Path
    made: Callable[[], None] = field(default=print, metadata={"stored": False})


@dataclass(frozen=True)
class Either:
    """One or the other."""

    of: About | Mass = field(metadata={"inline": True})
    n: int


def written() -> Any:
    masses = (Mass("a", 1.0), Mass("b", float("nan")))
    made = Result(
        About("emps"), masses, masses, None, np.eye(2), "low", ("x", 1), {"build": 0.1},
        ("c",), None, None, Path("a.parquet"),
    )  # fmt: skip
    return json.loads(json.dumps(plain(made)))


def test_what_is_written_fits():
    Draft202012Validator.check_schema(schema(Result))
    Draft202012Validator(schema(Result)).validate(written())
    Draft202012Validator(schema(tuple[Result, ...])).validate([written(), written()])


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("case",), 1),
        (("masses", "a", "value"), "much"),
        (("masses", "a", "name"), "a"),
        (("rows", 0, "value"), "much"),
        (("rows", 0, "colour"), "red"),
        (("best",), 3),
        (("matrix",), 3),
        (("kind",), "middle"),
        (("pair", 1), "x"),
        (("seconds", "build"), "long"),
        (("class",), "c"),
        (("horizon",), "x"),
        (("count",), 1.5),
        (("file",), None),
        (("made",), 1),
    ],
)
def test_what_is_wrong_does_not(path: tuple[Any, ...], value: Any) -> None:
    data = copy.deepcopy(written())
    at = data
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    with pytest.raises(ValidationError):
        Draft202012Validator(schema(Result)).validate(data)


def test_every_key_is_required():
    validator = Draft202012Validator(schema(Result))
    for key in written():
        with pytest.raises(ValidationError):
            validator.validate({k: v for k, v in written().items() if k != key})


def test_meanings_and_units_are_said():
    found = schema(Result)
    assert found["description"] == "One result.\n\nWhat it is about."
    assert found["$defs"]["Mass"]["properties"]["value"]["description"] == "moved mass, in kg"


def test_one_of_several_inline():
    Draft202012Validator.check_schema(schema(Either))
    validator = Draft202012Validator(schema(Either))
    for of in (About("emps"), Mass("a", 1.0)):
        validator.validate(json.loads(json.dumps(plain(Either(of, 3)))))
    with pytest.raises(ValidationError):
        validator.validate({"case": "emps", "name": "a", "value": 1.0, "n": 3})


def test_what_is_not_data_has_no_schema():
    @dataclass(frozen=True)
    class Odd:
        made: Callable[[], None]

    with pytest.raises(TypeError, match="no schema for"):
        schema(Odd)


def test_two_dataclasses_of_one_name_are_refused():
    """One would be described as the other."""

    def another() -> type:
        @dataclass(frozen=True)
        class Mass:
            stones: float

        return Mass

    with pytest.raises(TypeError, match="two of these have one name"):
        schema(tuple[Mass, another()])
