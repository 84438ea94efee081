"""Plain mappings become dataclasses, and every mistake is one line with the way out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import pytest

from hybridid.naming import unknown
from hybridid.plain import build


class OwnError(ValueError):
    pass


@dataclass(frozen=True)
class Inner:
    name: str
    gain: float = 1.0


@dataclass(frozen=True)
class Outer:
    title: str
    size: int
    ratio: float = 0.5
    on: bool = True
    kind: Literal["low", "high"] = "low"
    tags: tuple[str, ...] = ()
    span: tuple[float, float] | None = None
    inner: tuple[Inner, ...] = ()
    step: Inner | float | None = None

    def __post_init__(self) -> None:
        if self.size < 0:
            raise ValueError("size is negative")


def made(**values: object) -> Outer:
    return build(Outer, {"title": "a", "size": 3, **values}, "here", OwnError)


def test_values_are_converted_by_their_fields():
    outer = made(ratio=2, tags="one", span=[0, 1], inner=[{"name": "x", "gain": 2}], step=0.5)
    assert outer == Outer("a", 3, 2.0, True, "low", ("one",), (0.0, 1.0), (Inner("x", 2.0),), 0.5)
    assert isinstance(outer.ratio, float)
    assert made(step={"name": "y"}).step == Inner("y")
    assert made(step=None).step is None


def test_a_tuple_of_dataclasses_may_be_a_mapping_by_name():
    by_name = made(inner={"x": {"gain": 2.0}, "y": {}})
    assert by_name.inner == (Inner("x", 2.0), Inner("y"))
    assert made(inner={"name": "x", "gain": 2.0}).inner == (Inner("x", 2.0),)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"raito": 1.0}, "here: unknown key 'raito': did you mean 'ratio'? allowed: title, size"),
        ({"size": 1.5}, "here: size is 1.5: expected a whole number"),
        ({"size": True}, "here: size is True: expected a whole number"),
        ({"size": -1}, "here: size is negative"),
        ({"size": 10**400}, "here: size is 1000"),
        ({"ratio": -(10**400)}, "here: ratio is -1000"),
        ({"ratio": "much"}, "here: ratio is 'much': expected a number"),
        ({"on": "yes"}, "here: on is 'yes': expected true or false"),
        ({"kind": "hihg"}, "here: kind is 'hihg': did you mean 'high'? allowed: low, high"),
        ({"title": None}, "here: key 'title' is missing"),
        ({"tags": ["a", 2]}, "here: tags[1] is 2: expected text"),
        ({"span": [1.0]}, "here: span has 1 values, expected 2"),
        ({"inner": [{"name": "x", "gian": 2}]}, "here: inner[0]: unknown key 'gian': did you mean 'gain'?"),
        ({"inner": {"x": {"gian": 2}}}, "here: inner.x: unknown key 'gian': did you mean 'gain'?"),
        ({"inner": {"x": 3}}, "here: inner.x: expected a mapping of keys to values, got 3"),
        ({"step": {"nam": "y"}}, "here: step: unknown key 'nam': did you mean 'name'?"),
    ],
)
def test_a_mistake_is_one_line(values, said):
    with pytest.raises(OwnError) as caught:
        made(**values)
    assert str(caught.value).startswith(said)
    assert "\n" not in str(caught.value)


def test_no_mapping_at_all():
    with pytest.raises(OwnError, match="here: expected a mapping"):
        build(Inner, [1, 2], "here", OwnError)


def test_the_nearest_name_is_found_whatever_its_case():
    assert "did you mean 'DATA'?" in unknown("column", "data", ["DATA", "t"])
    assert "did you mean" not in unknown("column", "xyzzy", ["DATA", "t"])
    assert unknown("column", "a", []).endswith("allowed: none")
