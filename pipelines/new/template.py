"""The templates: plants of machines that many engineers have, and how their signals are called elsewhere."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeGuard

import yaml

from hybridid.declarations import Signal
from hybridid.plain import build
from hybridid.plants.plant import Plant
from pipelines.shared.errors import ConfigError, unknown

_HERE = Path(__file__).parent / "templates"


@dataclass(frozen=True)
class Scale:
    """A constant at the head of the plant's file, as the recordings tell it: of the signal ``of``, or of what
    it is ``less`` another one, its ``half_range``; its ``size`` or ``speed``, exceeded 5 % of the time."""

    of: str
    kind: Literal["half_range", "size", "speed"]
    less: str | None = None


@dataclass(frozen=True)
class Derivative:
    """An input that is made of the output ``of``: its ``order``-th time derivative, or of order -1 its
    integral."""

    of: str
    order: Literal[-1, 1, 2]


@dataclass(frozen=True)
class _Described:
    """A template's YAML file: other names of each signal, and ``remarks`` on what the user is to set."""

    meaning: str
    signals: Mapping[str, tuple[str, ...]]
    scales: Mapping[str, Scale]
    derivatives: Mapping[str, Derivative] = field(default_factory=dict)
    effects: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Template:
    """A plant to begin with, its source text, and what turns a recording into its signals."""

    kind: str
    about: _Described
    plant: type[Plant]
    source: str

    @property
    def inputs(self) -> tuple[Signal, ...]:
        """The recorded signals that drive the plant."""
        return tuple(signal for signal in self.plant.inputs if signal.name not in self.about.derivatives)

    @property
    def made(self) -> tuple[tuple[Signal, Derivative], ...]:
        """The inputs that are made of an output."""
        by_name = {signal.name: signal for signal in self.plant.inputs}
        return tuple((by_name[name], derivative) for name, derivative in self.about.derivatives.items())

    @property
    def outputs(self) -> tuple[Signal, ...]:
        """The signals that are measured."""
        return self.plant.outputs

    def code(self, name: str, scales: Mapping[str, float]) -> str:
        """The plant's file for the machine ``name``, with these numbers for its constants."""
        text = self.source.replace(f'name = "{self.kind}"', f'name = "{name}"')
        for constant, value in scales.items():
            text = re.sub(rf"(?m)^{constant} = \S+", f"{constant} = {value:g}", text)
        return text


def kinds() -> tuple[str, ...]:
    """The names of all templates, ``blank`` last."""
    found = sorted(path.stem for path in _HERE.glob("*.yaml"))
    return tuple(sorted(found, key=lambda kind: kind == "blank"))


def template(kind: str) -> Template:
    """The template called ``kind``.

    Raises:
        ConfigError: if there is none; gives the nearest name.
    """
    if kind not in kinds():
        raise ConfigError(unknown("template", kind, kinds()))
    module = importlib.import_module(f"pipelines.new.templates.{kind}")
    plant = next(one for one in vars(module).values() if _is_plant(one) and one.__module__ == module.__name__)
    return Template(kind, _described(kind), plant, (_HERE / f"{kind}.py").read_text(encoding="utf-8"))


def _is_plant(one: object) -> TypeGuard[type[Plant]]:
    return inspect.isclass(one) and issubclass(one, Plant)


def meanings() -> dict[str, str]:
    """What each template is, by its name."""
    return {kind: _described(kind).meaning for kind in kinds()}


def _described(kind: str) -> _Described:
    content: Mapping[str, Any] = yaml.safe_load((_HERE / f"{kind}.yaml").read_text(encoding="utf-8"))
    return build(_Described, content, f"template {kind}", ConfigError)
