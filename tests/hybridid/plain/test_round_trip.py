"""What ``plain`` wrote, through strict JSON, is what ``restored`` gives back."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from hybridid.plain import plain, restored

NAN, INF = float("nan"), float("inf")


@dataclass(frozen=True)
class Parameter:
    name: str
    value: float
    lower: float = field(default=0.0, metadata={"null": -INF})


@dataclass(frozen=True)
class About:
    case: str
    model: str = "gray box"


@dataclass(frozen=True, eq=False)
class Result:
    about: About = field(metadata={"inline": True})
    parameters: tuple[Parameter, ...] = field(metadata={"by": "name"})
    rows: tuple[Parameter, ...]
    one: Parameter | None
    matrix: NDArray[np.float64]
    counts: NDArray[np.int64]
    history: tuple[float, ...]
    pair: tuple[str, int]
    known: Mapping[str, float]
    curves: dict[str, NDArray[np.float64]]
    by_lag: Mapping[int, tuple[float, ...]]
    kind: Literal["free_run", "horizon"]
    file: Path
    horizon: float | None
    at: Mapping[str, Any]
    converged: bool
    alike: tuple[str, ...] = field(metadata={"key": "class"})
    made: object = field(default=None, metadata={"stored": False})


def number(random: np.random.Generator) -> float:
    return float(random.choice([random.normal(), 1e-300, 12.0, NAN, INF, -INF]))


def a_parameter(random: np.random.Generator, name: str) -> Parameter:
    return Parameter(name, number(random), float(random.choice([0.5, -INF])))


def a_result(seed: int) -> Result:
    random = np.random.default_rng(seed)
    some = int(random.integers(0, 4))
    rows = tuple(a_parameter(random, f"p{k}") for k in range(some))
    matrix = random.normal(size=(some, 3))
    matrix[random.random(matrix.shape) < 0.3] = NAN
    return Result(
        about=About("emps"),
        parameters=rows,
        rows=rows[::-1],
        one=rows[0] if rows else None,
        matrix=matrix,
        counts=random.integers(0, 9, some),
        history=tuple(number(random) for _ in range(some)),
        pair=("a", some),
        known={f"k{k}": number(random) for k in range(some)},
        curves={"u": random.normal(size=some)},
        by_lag={3: (1.0, NAN)},
        kind="horizon" if some else "free_run",
        file=Path("preprocess") / "a.parquet",
        horizon=number(random) if some == 2 else None,
        at={"residual.depth": [1, None, {"a": "b"}]},
        converged=bool(some),
        alike=("a", "b"),
        made=object(),
    )


def as_finite(value: Any) -> Any:
    """Infinity is stored as null and so comes back as nan."""
    return NAN if isinstance(value, float) and math.isinf(value) else value


@pytest.mark.parametrize("seed", range(20))
def test_a_result_comes_back_through_json(seed: int) -> None:
    made = a_result(seed)
    text = json.dumps(plain(made), allow_nan=False)
    found = restored(Result, json.loads(text), "result.json")
    assert json.dumps(plain(found), allow_nan=False) == text
    assert (found.about, found.kind, found.file, found.at) == (made.about, made.kind, made.file, made.at)
    assert (found.pair, found.converged) == (made.pair, made.converged)
    assert found.alike == made.alike
    np.testing.assert_array_equal(found.matrix.ravel(), made.matrix.ravel())
    np.testing.assert_array_equal(found.history, [as_finite(v) for v in made.history])
    np.testing.assert_array_equal(found.counts, made.counts)
    np.testing.assert_array_equal(found.curves["u"], made.curves["u"])
    np.testing.assert_array_equal(list(found.by_lag[3]), [1.0, NAN])
    assert found.matrix.dtype == np.float64
    assert [p.lower for p in found.parameters] == [p.lower for p in made.parameters]
    assert [p.name for p in found.rows] == [p.name for p in made.rows]
    assert found.made is None


def test_null_is_what_the_field_says():
    assert math.isnan(restored(Parameter, {"name": "a", "value": None}, "here").value)
    assert restored(Parameter, {"name": "a", "value": 1, "lower": None}, "here").lower == -INF


def test_the_forms_that_metadata_name():
    made = plain(a_result(1))
    assert made["case"] == "emps"
    assert "about" not in made
    assert "made" not in made
    assert made["class"] == ["a", "b"]
    assert set(plain(a_result(3))["parameters"]) == {p.name for p in a_result(3).parameters}


def test_numpy_scalars_become_numbers():
    assert json.dumps(plain({"a": np.float32(0.5), "b": np.int64(3), "c": np.True_, 4: np.nan})) == (
        '{"a": 0.5, "b": 3, "c": true, "4": null}'
    )


def test_what_json_cannot_hold_is_refused():
    with pytest.raises(TypeError, match="a object cannot be written as plain data"):
        plain({"a": object()})


def test_a_tuple_of_results():
    rows = restored(
        tuple[Parameter, ...], [{"name": "a", "value": 1}, {"name": "b", "value": 2}], "rows.json"
    )
    assert rows == (Parameter("a", 1.0), Parameter("b", 2.0))


def test_more_keys_than_known_are_ignored():
    assert restored(Parameter, {"name": "a", "value": 1.0, "colour": "red"}, "here") == Parameter("a", 1.0)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ({"name": "a"}, "fit/x.json: key 'value' is missing; keys: name, value, lower"),
        ({"name": "a", "value": "much"}, "fit/x.json: value is 'much': expected a number"),
        ({"name": None, "value": 1.0}, "fit/x.json: name is None: expected text"),
        ([1, 2], "fit/x.json: expected a mapping"),
    ],
)
def test_a_file_that_does_not_fit_is_one_line(data: Any, said: str) -> None:
    with pytest.raises(ValueError, match=r"fit/x\.json") as caught:
        restored(Parameter, data, "fit/x.json")
    assert str(caught.value).startswith(said)
    assert "\n" not in str(caught.value)


def test_the_line_says_which_row():
    with pytest.raises(ValueError, match=r"rows.json\[1\]: key 'value' is missing"):
        restored(tuple[Parameter, ...], [{"name": "a", "value": 1}, {"name": "b"}], "rows.json")
