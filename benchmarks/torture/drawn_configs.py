"""Values of keys and model files that Hypothesis draws: understood, or refused in one line."""

from __future__ import annotations

import json
import tempfile
import typing
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st

from benchmarks.torture.case import check_line
from hybridid.plain import build, plain
from hybridid.settings import declared
from hybridid.settings.bounds import options
from hybridid.settings.declare import Declared
from pipelines.shared.augmented import taken_up
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import describe_model
from pipelines.shared.modelling import model_of
from pipelines.shared.sections.known import SECTIONS
from pipelines.shared.sections.residual import KINDS

NUMBERS = st.integers() | st.integers(min_value=10**400) | st.floats()
VALUES = st.recursive(
    st.none() | st.booleans() | NUMBERS | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=8,
)
"""Whatever a config or a JSON file may hold."""
CONFIG = {
    "plant": "hybridid.plants.emps:EMPS",
    "effects": ["viscous", "coulomb"],
    "parameters": {
        "M": {"lower": 1.0, "upper": 150.0},
        "carriage": {"viscous": {"f_v": {"guess": 200.0}}},
    },
}
"""A sound model."""


@cache
def _settings() -> tuple[tuple[str, type, Declared], ...]:
    """Every key that is declared, with its section."""
    classes = [*SECTIONS.items(), *(("residual", cls) for cls in KINDS.values())]
    return tuple((name, cls, one) for name, cls in classes for one in declared(cls))


@st.composite
def settings_given(draw: st.DrawFn) -> tuple[str, type, Declared, Any]:
    """A key, and a value for it."""
    return (*draw(st.sampled_from(_settings())), draw(NUMBERS | st.lists(NUMBERS, max_size=3) | VALUES))


def setting_is_of_its_type(drawn: tuple[str, type, Declared, Any]) -> None:
    """A value of a key is parsed to the declared type, or refused in a line."""
    section, cls, one, value = drawn
    *above, last = one.name.split(".")
    given: Any = {last: value}
    for key in reversed(above):
        given = {key: given}
    try:
        made: Any = build(cls, given, section, ConfigError)
    except ConfigError as refused:
        check_line(refused)
        return
    for key in (*above, last):
        made = getattr(made, key, made)
    if not hasattr(made, "__dataclass_fields__"):
        assert any(_is_of(made, option) for option in options(one.hint)), (one.name, made)


def _is_of(value: Any, hint: Any) -> bool:
    """Whether a value has a declared type."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin is typing.Literal:
        return value in arguments
    if origin is tuple and not isinstance(value, tuple):
        return False
    if origin is tuple:
        inner = arguments[:1] * len(value) if arguments[-1] is Ellipsis else arguments
        return all(any(_is_of(v, o) for o in options(h)) for v, h in zip(value, inner, strict=True))
    if hint is type(None):
        return value is None
    kind = origin or hint
    return kind is Any or (isinstance(value, kind) and (kind is not int or not isinstance(value, bool)))


@cache
def _model_file() -> str:
    """The model.json of a sound model."""
    settings = Settings("emps", CONFIG)
    return json.dumps(plain(describe_model(settings, model_of(settings), "measured")))


def _places(node: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The places in a JSON document, each by its keys and indices."""
    below = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    return [at, *(place for key, value in below for place in _places(value, (*at, key)))]


@st.composite
def model_files(draw: st.DrawFn) -> tuple[tuple[Any, ...], str]:
    """A place in a model.json, and the file with another value there."""
    content = json.loads(_model_file())
    place = draw(st.sampled_from(_places(content)))
    value = draw(VALUES)
    if not place:
        return place, json.dumps(value)
    node = content
    for key in place[:-1]:
        node = node[key]
    node[place[-1]] = value
    return place, json.dumps(content)


def model_file_is_read_or_refused(drawn: tuple[tuple[Any, ...], str]) -> None:
    """A changed model.json gives a model, the same if only what describes it was changed, or a line."""
    place, text = drawn
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.json"
        path.write_text(text, encoding="utf-8")
        try:
            model = model_of(Settings("emps", {**taken_up({"model": str(path)}), "model": None}))
        except ConfigError as refused:
            check_line(refused)
            return
    if place[:1] != ("config",):
        assert model.parameters == model_of(Settings("emps", CONFIG)).parameters
    assert np.isfinite(model.values()).all()
