"""The section ``trace`` of a config: what is tried where, on which horizons, by which rules."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hybridid.declarations import Port
from hybridid.effects.effect import Effect
from hybridid.effects.library import EFFECTS, effect_named
from hybridid.records.record import Record
from hybridid.records.store import load_record
from hybridid.trace.rules import Rules
from hybridid.trace.split import Split, by_blocks, by_record
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.findings import Prepared
from pipelines.shared.modelling import plant_of
from pipelines.shared.sources import Named, chosen

AUTO = "auto"
ENOUGH = 10
"""Horizons to fit, and to judge by, that the automatic horizon leaves."""
RULES = ("alpha", "worth", "tie", "stands_in", "most_effects")
KEYS = ("records", "held_out", "horizon", "effects", "extra_effects", "ports", *RULES, "processes")
_SHARES = ("alpha", "worth", "tie", "stands_in")


@dataclass(frozen=True)
class Request:
    """What is to be tried: ``effects`` at their ports (``ports`` None: all), by ``rules``."""

    effects: tuple[Effect, ...]
    ports: tuple[str, ...] | None
    rules: Rules
    horizon: float
    processes: int


def request_of(settings: Settings) -> Request:
    """The section ``trace`` as configured.

    Raises:
        ConfigError: if an effect or port is unknown or a number cannot be.
    """
    effects = (*_library(settings), *_own(settings))
    for effect in effects:
        if [e.id for e in effects].count(effect.id) > 1:
            raise ConfigError(f"trace.extra_effects: two effects to try are called {effect.id}")
    return Request(
        effects, _ports(settings, effects), _rules(settings), _horizon(settings), _processes(settings)
    )


def own_effects(settings: Settings) -> list[str]:
    """Import paths of the user's own effects that are tried beside the library."""
    return [str(entry) for entry in _list(settings, "trace.extra_effects", [])]


def division(records: Sequence[Named], settings: Settings) -> tuple[list[Named], list[Named]]:
    """The records to fit, and those to judge on (none: alternate horizons of the fitted judge).

    Raises:
        ConfigError: if a name matches no record, or one record were to serve both ways.
    """
    fitted = chosen(records, settings.get("trace.records"), "trace.records")
    wanted = settings["trace.held_out"]
    if wanted is None:
        return fitted, []
    if wanted == AUTO:
        return fitted, [r for r in records if r.role == "validation" and r not in fitted]
    held_out = chosen(records, wanted, "trace.held_out")
    twice = [r.name for r in held_out if r in fitted]
    if twice:
        raise ConfigError(
            f"trace.held_out: record {twice[0]} is fitted too; "
            "trace.held_out=null judges on alternate horizons of it"
        )
    return fitted, held_out


def fitting_horizon(request: Request, prepared: Sequence[Prepared], settings: Settings) -> Request:
    """``request``, its horizon short enough for ``ENOUGH`` of them on either side if it is automatic."""
    if settings["trace.horizon"] != AUTO:
        return request
    fitted, held_out = ([r.row["n"] * r.row["dt"] for r in part] for part in division(prepared, settings))
    least = min(sum(fitted), sum(held_out)) if held_out else sum(fitted) / 2
    return replace(request, horizon=min(request.horizon, least / ENOUGH))


def split_of(prepared: Sequence[Prepared], settings: Settings, horizon: float) -> Split:
    """The horizons that are fitted and those that are held out.

    Raises:
        ConfigError: if a horizon is shorter than two samples.
        ValueError: if there are too few horizons for a verdict.
    """
    fitted, held_out = (_loaded(part) for part in division(prepared, settings))
    samples = round(horizon / fitted[0].dt)
    if samples < 2:
        raise ConfigError(
            f"trace.horizon is {horizon:g} s: record {fitted[0].name} is sampled every {fitted[0].dt:g} s, "
            "a horizon needs 2 samples"
        )
    return by_record(fitted, held_out, samples) if held_out else by_blocks(fitted, samples)


def _loaded(prepared: Sequence[Prepared]) -> list[Record]:
    return [load_record(record.file) for record in prepared]


def _library(settings: Settings) -> tuple[Effect, ...]:
    names = settings.get("trace.effects")
    return (
        EFFECTS
        if names is None
        else tuple(_named(n, "trace.effects") for n in _list(settings, "trace.effects", []))
    )


def _own(settings: Settings) -> list[Effect]:
    for entry in own_effects(settings):
        if ":" not in entry:
            raise ConfigError(f"trace.extra_effects: {entry!r} is no import path, as in mymodule:MY_EFFECT")
    return [_named(entry, "trace.extra_effects") for entry in own_effects(settings)]


def _named(name: object, key: str) -> Effect:
    try:
        return effect_named(str(name))
    except ValueError as error:
        raise ConfigError(f"{key}: {error}") from error


def _ports(settings: Settings, effects: Sequence[Effect]) -> tuple[str, ...] | None:
    if settings.get("trace.ports") is None:
        return None
    ports: dict[str, Port] = {port.name: port for port in plant_of(settings).ports}
    wanted = tuple(str(name) for name in _list(settings, "trace.ports", []))
    for name in wanted:
        if name not in ports:
            raise ConfigError(unknown("port in trace.ports:", name, ports))
    if not any(effect.kind == ports[name].kind for effect in effects for name in wanted):
        raise ConfigError(f"trace.ports is {list(wanted)}: none of the effects to try acts there")
    return wanted


def _rules(settings: Settings) -> Rules:
    given: dict[str, Any] = {key: _number(settings, f"trace.{key}") for key in RULES}
    for key in _SHARES:
        if not 0 < given[key] < 1:
            raise ConfigError(f"trace.{key} is {given[key]:g}: must lie between 0 and 1")
    return Rules(**{**given, "most_effects": _whole(settings, "trace.most_effects", 1)})


def _horizon(settings: Settings) -> float:
    key = "validate.horizon" if settings["trace.horizon"] == AUTO else "trace.horizon"
    seconds = _number(settings, key)
    if not 0 < seconds < np.inf:
        raise ConfigError(f"{key} is {seconds:g}: must be a positive number of s")
    return seconds


def _processes(settings: Settings) -> int:
    if settings.get("trace.processes") is not None:
        return _whole(settings, "trace.processes", 1)
    from joblib import cpu_count

    return 1 if settings.in_sweep else int(cpu_count())


def _number(settings: Settings, key: str) -> float:
    value = settings[key]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ConfigError(f"{key} is {value!r}: must be a number")
    return float(value)


def _whole(settings: Settings, key: str, least: int) -> int:
    number = _number(settings, key)
    if number != int(number) or number < least:
        raise ConfigError(f"{key} is {settings[key]!r}: must be a whole number, {least} or more")
    return int(number)


def _list(settings: Settings, key: str, default: list[Any]) -> list[Any]:
    given = settings.get(key, default)
    if not isinstance(given, list):
        raise ConfigError(f"{key} is {given!r}: give a list, as in {key}=[a,b]")
    return given
