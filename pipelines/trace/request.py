"""The section ``trace`` of a config: the effects to try, their ports, the horizons and the rules."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from hybridid.declarations import Port, Signal
from hybridid.effects.effect import Effect
from hybridid.effects.library import effect_named, library_for
from hybridid.effects.variable import Variable
from hybridid.naming import listed
from hybridid.trace.horizons.split import automatic_horizon
from hybridid.trace.rules import PAIRS, Rules
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.imports import named
from pipelines.shared.modelling import channels_of, plant_of
from pipelines.shared.pool import core_count
from pipelines.shared.prepared import Prepared
from pipelines.shared.sections.searches import TraceSection
from pipelines.shared.sections.stages import ValidateSection
from pipelines.shared.sources import Named, chosen


@dataclass(frozen=True)
class Request:
    """A trace as configured: ``effects`` to try at ``ports`` (None: all), judged by ``rules``, over horizons
    of ``horizon`` s, in parallel ``processes``. Where no effect explains, so many ``pairs`` of effects are
    tried, then ``laws`` composed. ``revise``: each declared effect is left out in turn. ``by_recording``:
    each parameter is tried with a value for each record. Learned efforts and laws depend on ``variables``
    (None: all). After ``time_limit`` s (None: none) nothing further begins."""

    effects: tuple[Effect, ...]
    ports: tuple[str, ...] | None
    rules: Rules
    horizon: float
    processes: int
    laws: bool = True
    pairs: int = PAIRS
    revise: bool = False
    by_recording: bool | None = None
    variables: tuple[Variable, ...] | None = None
    time_limit: float | None = None


def request_of(settings: Settings) -> Request:
    """The section ``trace`` as configured.

    Raises:
        ConfigError: if an effect or port is unknown or a number is not allowed.
    """
    section = section_of(settings)
    seen = (*plant_of(settings).inputs, *channels_of(settings))
    effects = _without((*_library(section, settings, seen), *_own(section)), section.leave_out)
    for effect in effects:
        if [e.id for e in effects].count(effect.id) > 1:
            raise ConfigError(f"trace.extra_effects: two effects to try are called {effect.id}")
        for name in effect.channels:
            known = [signal.name for signal in seen]
            if name not in known:
                raise ConfigError(unknown(f"channel that effect {effect.id} of trace sees", name, known))
    ports = _ports(settings, section, effects)
    horizon, processes = _horizon(settings, section), _processes(settings, section)
    asked = (section.laws, section.pairs, section.revise, section.by_recording)
    limits = (section.variables, section.time_limit)
    return Request(effects, ports, section.rules, horizon, processes, *asked, *limits)


def section_of(settings: Settings) -> TraceSection:
    """The section ``trace`` with its keys and values checked.

    Raises:
        ConfigError: if a key or a value is not allowed.
    """
    return settings.section("trace", TraceSection)


def imported_effects(settings: Settings) -> list[str]:
    """Import paths of the user's own effects, from ``trace.effects`` and ``trace.extra_effects``."""
    section = section_of(settings)
    return [name for name in (*(section.effects or ()), *section.extra_effects) if ":" in name]


def division(records: Sequence[Named], settings: Settings) -> tuple[list[Named], list[Named]]:
    """The records to fit, and those to judge on (none: alternate horizons of the fitted records judge).

    Raises:
        ConfigError: if a name matches no record, or a record is in both lists.
    """
    section = section_of(settings)
    fitted = chosen(records, section.records, "trace.records")
    wanted = section.held_out
    if wanted is None:
        return fitted, []
    if isinstance(wanted, str):  # auto
        return fitted, [r for r in records if r.role == "validation" and r not in fitted]
    held_out = chosen(records, wanted, "trace.held_out")
    twice = [r.name for r in held_out if r in fitted]
    if twice:
        raise ConfigError(
            f"trace.held_out: record {twice[0]} is fitted too; "
            "trace.held_out=null judges on alternate horizons of it"
        )
    return fitted, held_out


def check_by_recording(section: TraceSection, fitted: Sequence[Named], held_out: Sequence[Named]) -> None:
    """Whether what differs by recording can be judged, where it is asked: on parts of each record that were
    not fitted.

    Raises:
        ConfigError: if a record is held out as a whole, or only one is fitted.
    """
    if section.by_recording and held_out:
        names = listed([record.name for record in held_out])
        raise ConfigError(
            f"trace.by_recording: no fit knows a parameter's value in {names}, held out as a whole; "
            "trace.held_out=null judges on alternate horizons of trace.records"
        )
    if section.by_recording and len(fitted) < 2:
        raise ConfigError(
            f"trace.by_recording: trace.records chooses {listed([record.name for record in fitted])} alone; "
            "nothing can differ by recording"
        )


def is_automatic(settings: Settings) -> bool:
    """Whether ``trace.horizon`` leaves the length of the horizons open."""
    return isinstance(section_of(settings).horizon, str)


def fitting_horizon(request: Request, prepared: Sequence[Prepared], settings: Settings) -> Request:
    """``request`` with a shorter horizon if the horizon is automatic and the records are short. Before the
    fit the machine's dynamics are not known."""
    if not is_automatic(settings):
        return request
    fitted, held_out = ([r.seconds for r in part] for part in division(prepared, settings))
    return replace(request, horizon=automatic_horizon(fitted, held_out, request.horizon, step=prepared[0].dt))


def _library(section: TraceSection, settings: Settings, seen: Sequence[Signal]) -> tuple[Effect, ...]:
    """The effects of ``trace.effects``, which may follow any of the signals ``seen``; None: the library."""
    if section.effects is None:
        return library_for(channels_of(settings))
    return tuple(_named(name, "trace.effects", seen) for name in section.effects)


def _without(effects: tuple[Effect, ...], names: Sequence[str]) -> tuple[Effect, ...]:
    """The ``effects`` but for those that are left out by their ids."""
    known = [effect.id for effect in effects]
    for name in names:
        if name not in known:
            raise ConfigError(unknown("effect in trace.leave_out:", name, known))
    left = tuple(effect for effect in effects if effect.id not in names)
    if not left:
        raise ConfigError("trace.leave_out names every effect to try")
    return left


def _own(section: TraceSection) -> list[Effect]:
    for entry in section.extra_effects:
        if ":" not in entry:
            raise ConfigError(f"trace.extra_effects: {entry!r} is no import path, as in mymodule:MY_EFFECT")
    return [_named(entry, "trace.extra_effects") for entry in section.extra_effects]


def _named(name: str, key: str, seen: Sequence[Signal] = ()) -> Effect:
    if ":" in name:
        named(name, key)
    try:
        return effect_named(name, seen)
    except ValueError as error:
        raise ConfigError(f"{key}: {error}") from error


def _ports(settings: Settings, section: TraceSection, effects: Sequence[Effect]) -> tuple[str, ...] | None:
    if section.ports is None:
        return None
    ports: dict[str, Port] = {port.name: port for port in plant_of(settings).ports}
    for name in section.ports:
        if name not in ports:
            raise ConfigError(unknown("port in trace.ports:", name, ports))
    if not any(effect.kind == ports[name].kind for effect in effects for name in section.ports):
        raise ConfigError(f"trace.ports is {list(section.ports)}: none of the effects to try acts there")
    return section.ports


def _horizon(settings: Settings, section: TraceSection) -> float:
    if isinstance(section.horizon, str):  # auto
        return settings.section("validate", ValidateSection).horizon
    return section.horizon


def _processes(settings: Settings, section: TraceSection) -> int:
    if section.processes is not None:
        return section.processes
    return 1 if settings.in_sweep else core_count()
