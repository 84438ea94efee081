"""``hybridid cases`` and ``hybridid effects``: what there is to choose from."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.console import RenderableType
from rich.text import Text

from hybridid.declarations import Port, PortKind, Signal
from hybridid.effects.dimension import Dimension
from hybridid.effects.effect import Effect
from hybridid.effects.library import effect_named, library_for
from hybridid.model import Model
from hybridid.quantities import number
from hybridid_cli.config_files import options, user_folders
from hybridid_cli.tables import rendered
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.imports import named
from pipelines.shared.own_code import make_importable


def cases(name: str, words: Sequence[str]) -> int:
    """Print every case, or the one named."""
    folders, rest = _arguments(words)
    asked = [word.removeprefix("case=") for word in rest if "=" not in word or word.startswith("case=")]
    overrides = [word for word in rest if "=" in word and not word.startswith("case=")]
    known = options("case", folders)
    for case in asked:
        if case not in known:
            raise ConfigError(unknown("case", case, known))
    for case in asked or known:
        print(rendered(_case(case, folders, overrides)))
    return 0


def effects(name: str, words: Sequence[str]) -> int:
    """Print every effect, or the details of those named."""
    folders, asked = _arguments(words)
    make_importable(folder.resolve() for folder in folders)
    if not asked:
        print("\n".join(_described(effect) for effect in library_for([_CHANNEL])))
        print("hybridid effects NAME also says how an effect differs from similar ones")
        return 0
    for word in asked:
        if ":" in word:
            named(word, "effect")
        try:
            effect = effect_named(word, [_CHANNEL])
            print(f"{_described(effect)}{_told_apart(effect)}\n")
        except ValueError as error:
            raise ConfigError(str(error)) from error
    return 0


_NEEDS = {
    "load": "the effort that the port carries (its drive or its load)",
    "drive": "the effort of the drive at the port",
    "both_sides": "the efforts of the drive and of the load at the port",
    "level": "what sets the level of the port's friction, such as a field or a pressure",
    "rate": "the rate of change of the level, or of an output that no input changes at once",
}
# Stands for any input or channel of a case.
_CHANNEL = Signal("CHANNEL", "its unit")
# What a port may measure in, for units that depend on it.
_LINEAR = Port("linear", "effort", effort_unit="N", effort_scale=1.0, position_unit="m")
_ROTARY = Port("rotary", "effort", effort_unit="Nm", effort_scale=1.0, position_unit="rad")
_LEVEL = Port("level", "flow", effort_unit="m³/s", effort_scale=1.0, position_unit="m")
_HEAT = Port("heat", "flow", effort_unit="W", effort_scale=1.0, position_unit="°C")
_SIGNAL = Port("signal", "input", effort_unit="signal", effort_scale=1.0)
_PORTS: Mapping[PortKind, Sequence[Port]] = {
    "effort": (_LINEAR, _ROTARY), "flow": (_LEVEL, _HEAT), "input": (_SIGNAL,), "output": (_SIGNAL,)
}  # fmt: skip


def _arguments(words: Sequence[str]) -> tuple[list[Path], list[str]]:
    """The user's folders, and the words that are no flags."""
    folders, rest, skip = user_folders(words), [], False
    for word in words:
        if skip:
            skip = False
        elif word.partition("=")[0] in ("--config-dir", "-cd"):
            skip = "=" not in word
        elif word.startswith("-"):
            raise ConfigError(unknown("flag", word, ["--config-dir", "--help"]))
        else:
            rest.append(word)
    if skip:
        raise ConfigError("--config-dir wants a folder after it")
    for folder in folders:
        if not folder.is_dir():
            raise ConfigError(f"--config-dir {folder}: no such folder")
    return folders, rest


def _case(name: str, folders: Sequence[Path], overrides: Sequence[str]) -> list[RenderableType]:
    """One case as text: what it is, its model, its records and where they come from."""
    from pipelines.shared.modelling import model_of

    settings = _settings(name, folders, overrides)
    lines: list[RenderableType] = [Text(f"{name}: {settings.get('case.title', '')}", style="bold")]
    if settings.get("case.source"):
        lines.append(Text(f"  source   {settings['case.source']}"))
    model = model_of(settings)
    signals = {
        "inputs": ", ".join(f"{s.name} [{s.unit}]" for s in model.plant.inputs),
        **({"channels": ", ".join(f"{s.name} [{s.unit}]" for s in model.channels)} if model.channels else {}),
        "outputs": ", ".join(f"{s.name} [{s.unit}]" for s in model.outputs),
        "effects": ", ".join(f"{term.effect.id}@{term.port}" for term in model.terms),
        "ports": ", ".join(f"{p.name} ({p.kind})" for p in model.plant.ports),
    }
    lines.append(Text(f"  plant    {model.plant.name}: {model.plant.meaning}"))
    lines += [Text(f"  {key:<8} {value}") for key, value in signals.items()]
    moving = [port for port in model.equation_ports if port.kind == "effort"]
    lines += [Text(f"  load     {port.name}: {_load(port)}") for port in moving]
    return [*lines, *_controller(settings, model), *_records(settings), Text("")]


def _controller(settings: Settings, model: Model) -> list[RenderableType]:
    """The law that ran the machine, where the case has one: what it follows, with its numbers."""
    from pipelines.shared.controlling import loop_of

    loop = loop_of(settings, model.inputs, model.outputs)
    if loop is None:
        return []
    law = loop.controller
    numbers = ", ".join(
        f"{p.name} {number(loop.values.get(p.name, p.guess), 6)} {p.unit}" for p in law.parameters
    )
    follows = ", ".join(f"{loop.references.get(r.name, r.name)} [{r.unit}]" for r in law.references)
    said = f"{law.name}: {law.meaning}; follows {follows}"
    return [Text(f"  control  {said}"), Text(f"           {numbers}")]


def _load(port: Port) -> str:
    """What a port says that it carries, or why it has no load."""
    said = {"drive": port.drive, "load": port.load, "level": port.level}
    given = "; ".join(f"{side}: {words}" for side, words in said.items() if words)
    return given or f"none ({port.no_load or 'none is declared'})"


def _records(settings: Settings) -> list[RenderableType]:
    from hybridid.records.record import RecordError
    from pipelines.shared.sources import Measured, sources_of

    try:
        sources = sources_of(settings)
    except RecordError as error:
        return [Text(f"  records  none at hand: {error}", style="yellow")]
    lines: list[RenderableType] = []
    for source in sources.found:
        where = (
            ", ".join(map(str, source.files)) if isinstance(source, Measured) else f"rig {source.rig.name}"
        )
        computed = not isinstance(source, Measured) or source.plan.simulated
        kind = "simulated" if computed else "measured"
        lines.append(Text(f"  record   {source.name} ({source.role}): {kind}, {where}"))
    return [*lines, *(Text(f"  note     {remark}", style="yellow") for remark in sources.remarks)]


def _settings(name: str, folders: Sequence[Path], overrides: Sequence[str]) -> Settings:
    """What a case would run with."""
    from hydra.errors import HydraException

    from hybridid_cli.composing import settings_of
    from hybridid_cli.explain import explained

    try:
        return settings_of([f"case={name}", *overrides], "run", folders)
    except HydraException as error:
        raise ConfigError(explained(error, "run", overrides)[0]) from error


def _described(effect: Effect) -> str:
    """What an effect is: equation, parameters with units, source."""
    lines = [
        f"{effect.id}: {effect.title}",
        f"  acts at   {effect.kind} ports"
        + (", from one into another" if effect.into else "")
        + (f"; a trace tries it only beside {effect.beside}" if effect.beside else ""),
        f"  equation  {effect.equation}",
    ]
    for parameter in effect.parameters:
        zero = " (zero removes the effect)" if parameter.nests else ""
        lines.append(
            f"  parameter {parameter.name} [{_unit(effect, parameter.dimension)}]: {parameter.meaning}{zero}"
        )
    lines += [f"  needs     {_NEEDS[need]}" for need in effect.needs]
    lines += [f"  needs     the input or channel {name}" for name in effect.channels]
    lines += [f"  state     {s.name} [{_unit(effect, s.dimension)}]: {s.meaning}" for s in effect.states]
    return "\n".join([*lines, _paragraph("source", effect.source)])


def _told_apart(effect: Effect) -> str:
    """How an effect shows, which others it is easily taken for, and the experiment that tells."""
    said = {
        "tells": effect.pattern,
        "alike": ", ".join(effect.look_alikes),
        "apart by": effect.separating_experiment,
    }
    return "".join(_paragraph(label, text) for label, text in said.items() if text)


def _paragraph(label: str, text: str) -> str:
    return textwrap.fill(f"  {label:<9} {text}", width=110, subsequent_indent=" " * 12) + "\n"


def _unit(effect: Effect, dimension: Dimension) -> str:
    """The unit at a linear and at a rotary port, at a level and at a temperature, or that of the signal."""
    ports = _PORTS[effect.kind]
    suited = [port for port in ports if effect.suits(port.position_unit)]
    return " or ".join(dict.fromkeys(dimension.unit(port) for port in suited or ports))
