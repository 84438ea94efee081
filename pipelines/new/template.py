"""The templates: plants of machines that many engineers have, and how their signals are called elsewhere."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, TypeGuard

import yaml

from hybridid.declarations import Signal
from hybridid.plain import build
from hybridid.plants.plant import Plant
from pipelines.new.absent import UNDRIVEN, without
from pipelines.shared.errors import ConfigError, unknown

UNMEASURED = "not measured"
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
class Lack:
    """A template without one of its signals. A recording can then not tell the parameter ``known``, which is
    fixed. ``head`` gives the lines that take the place of a constant at the head of the plant's file,
    ``scales`` the constants that another signal tells, ``words`` what the texts say in place of what."""

    known: str
    remark: str = ""
    head: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    scales: Mapping[str, Scale] = field(default_factory=dict)
    words: Mapping[str, str] = field(default_factory=dict)

    def headed(self, source: str) -> str:
        """A plant's ``source`` with the lines of ``head`` in place of the constants."""
        block = {constant: "".join(f"{line}\n" for line in lines) for constant, lines in self.head.items()}
        constants = "|".join(block)
        return re.sub(rf"(?m)^({constants}) = .*\n", lambda at: block[at[1]], source) if block else source

    def worded(self, text: str) -> str:
        """``text`` with the ``words`` in it replaced."""
        for said, now in self.words.items():
            text = text.replace(said, now)
        return text


@dataclass(frozen=True)
class _Described:
    """A template's YAML file: other names of each signal, and ``remarks`` on what the user is to set.
    ``without`` holds the signals that a machine may lack."""

    meaning: str
    signals: Mapping[str, tuple[str, ...]]
    scales: Mapping[str, Scale]
    derivatives: Mapping[str, Derivative] = field(default_factory=dict)
    effects: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    without: Mapping[str, Lack] = field(default_factory=dict)


@dataclass(frozen=True)
class Template:
    """A plant to begin with, its source text, and what turns a recording into its signals. ``absent`` are the
    signals of the plant that this machine lacks."""

    kind: str
    about: _Described
    plant: type[Plant]
    source: str
    absent: tuple[Signal, ...] = ()

    @property
    def inputs(self) -> tuple[Signal, ...]:
        """The recorded signals that drive the plant."""
        gone = (*self.about.derivatives, *(signal.name for signal in self.absent))
        return tuple(signal for signal in self.plant.inputs if signal.name not in gone)

    @property
    def made(self) -> tuple[tuple[Signal, Derivative], ...]:
        """The inputs that are made of an output."""
        by_name = {signal.name: signal for signal in self.plant.inputs}
        return tuple((by_name[name], derivative) for name, derivative in self.about.derivatives.items())

    @property
    def outputs(self) -> tuple[Signal, ...]:
        """The signals that are measured."""
        return tuple(signal for signal in self.plant.outputs if signal not in self.absent)

    @property
    def hides(self) -> bool:
        """Whether an output is not measured, so that a state of the plant is hidden."""
        return any(signal in self.plant.outputs for signal in self.absent)

    def lack_of(self, signal: Signal) -> str:
        """What it means that the machine lacks ``signal``, in words."""
        return UNMEASURED if signal in self.plant.outputs else UNDRIVEN

    def without(self, signals: Sequence[Signal]) -> Template:
        """The template of a machine that lacks ``signals``, each of which is in ``about.without``."""
        made = self
        for signal in signals:
            made = made._lacking(signal, self.about.without[signal.name])
        return made

    def _lacking(self, signal: Signal, lack: Lack) -> Template:
        source = lack.headed(without(self.source, signal.name, lack.known))
        kept = {name: one for name, one in self.about.scales.items() if name not in lack.head}
        about = replace(
            self.about,
            meaning=lack.worded(self.about.meaning),
            scales={**kept, **lack.scales},
            remarks=(*self.about.remarks, *filter(None, [lack.remark])),
        )
        return replace(self, about=about, source=lack.worded(source), absent=(*self.absent, signal))

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
