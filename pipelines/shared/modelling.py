"""From config to model and fit settings: plant, effects, parameters, estimator."""

from __future__ import annotations

import inspect
import math
import sys
from collections.abc import Iterator, Mapping
from typing import Any

from hybridid.blame import OwnCodeError, blamed_on
from hybridid.declarations import Signal
from hybridid.effects.effect import Effect
from hybridid.effects.library import library_for
from hybridid.model import Model, compose
from hybridid.model.compose import ADJUSTABLE
from hybridid.naming import shortened
from hybridid.plants.plant import Plant
from hybridid.settings.fit import FitSettings
from pipelines.shared.by_record import MARK, parameters_by_record
from pipelines.shared.channels import channels_of
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.imports import code_digests, named

KEYS = ("plant", "channels", "effects", "parameters")


def plant_of(settings: Settings) -> Plant:
    """The plant at the import path ``plant``, which names an instance or a class without arguments.

    Raises:
        ConfigError: if the path names neither.
    """
    found = named(settings["plant"], "plant")
    if inspect.isclass(found) and issubclass(found, Plant):
        found = _made(found, f"plant {settings['plant']}")
    if not isinstance(found, Plant):
        kind = "class" if inspect.isclass(found) else type(found).__name__
        raise ConfigError(f"plant {settings['plant']} is a {kind}, not a hybridid.plants.plant.Plant")
    return found


def _made(cls: type[Plant], what: str) -> Plant:
    """The plant that a class makes without arguments."""
    try:
        with blamed_on(cls):
            return cls()
    except OwnCodeError as error:
        raise ConfigError(f"{what}: {error}") from error


def model_of(settings: Settings) -> Model:
    """The case's plant with its effects and adjusted parameters.

    Entries of ``parameters`` for effects that are not selected are checked and then ignored.

    Raises:
        ConfigError: if an effect, port or parameter is unknown, or a number is not allowed.
    """
    plant, channels, by_record = plant_of(settings), channels_of(settings), _by_record(settings)
    entries = effect_entries(settings)
    for entry in entries:
        if ":" in entry:
            named(entry.partition("@")[0], "effect")
    try:
        bare = compose(plant, entries, channels=channels, by_record=by_record)
        names = {p.name for p in bare.parameters}
        given = adjustments(parameters_of(settings))
        for name in by_record:
            if name in given:
                raise ConfigError(f"parameters.{name} is set, but every record gives {name}: leave one out")
        ownable = names | _ownable(plant, [*library_for(channels), *(term.effect for term in bare.terms)])
        for name in given:
            if name not in ownable:
                raise ConfigError(unknown("parameter", name, ownable, allowed=names))
        own = {name: given[name] for name in given if name in names}
        model = compose(plant, entries, own, channels, by_record)
        _ = model.parameters  # raises if bounds contradict each other
    except ConfigError:
        raise
    except ValueError as error:
        raise ConfigError(str(error)) from error
    return model


def given_of(settings: Settings) -> tuple[Signal, ...]:
    """The plant's parameters that every record gives, with their units, in the order of the model's inputs.

    Raises:
        ConfigError: if the plant has no parameter of a name, or the config is wrong.
    """
    by_record = parameters_by_record(settings)
    if not by_record:
        return ()
    try:
        return Model(plant_of(settings), by_record=by_record).given
    except ValueError as error:
        raise ConfigError(str(error)) from error


def _by_record(settings: Settings) -> tuple[str, ...]:
    """The same names, also of a model that was stored without its records."""
    marked = [
        str(n) for n, one in parameters_of(settings).items() if isinstance(one, Mapping) and one.get(MARK)
    ]
    return tuple(dict.fromkeys([*marked, *parameters_by_record(settings)]))


def named_code(settings: Settings) -> dict[str, str]:
    """Digests of the code that the config names: the plant's and the effects' import paths."""
    return code_digests(
        [settings["plant"], *(e.partition("@")[0] for e in effect_entries(settings) if ":" in e)]
    )


def effect_entries(settings: Settings) -> list[str]:
    """``effects`` as a list of names.

    Raises:
        ConfigError: if it is anything else.
    """
    given = settings.get("effects", [])
    if not isinstance(given, list) or not all(isinstance(entry, str) for entry in given):
        raise ConfigError(f"effects is {given!r}: give a list of names, as in effects=[viscous,coulomb]")
    return given


def parameters_of(settings: Settings) -> dict[str, Any]:
    """``parameters`` as nested mappings; ``{carriage.viscous: {f_v: ...}}`` is as good as deeper ones.

    Raises:
        ConfigError: if it is no mapping.
    """
    given = settings.get("parameters", {})
    if not isinstance(given, Mapping):
        settings_of_one = ", ".join(ADJUSTABLE)
        raise ConfigError(
            f"parameters is {given!r}: give names with {settings_of_one}, as in {{M: {{lower: 1.0}}}}"
        )
    found: dict[str, Any] = {}
    _unfolded(given, found)
    return found


def _unfolded(given: Mapping[str, Any], into: dict[str, Any], path: str = "") -> None:
    """Put ``given`` ``into`` nested mappings, with dotted keys taken apart."""
    for key, value in given.items():
        name, _, rest = str(key).partition(".")
        value = {rest: value} if rest else value
        before = into.get(name)
        joined = isinstance(before, dict) and isinstance(value, Mapping)
        if not (joined or before is None or value is None):
            raise ConfigError(f"parameters.{path}{name} is given twice: {before!r} and {value!r}")
        if isinstance(value, Mapping):
            into[name] = before or {}
            _unfolded(value, into[name], f"{path}{name}.")
        elif before is None:
            into[name] = value


def adjustments(parameters: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """Nested ``parameters`` as ``{"carriage.viscous.f_v": {"lower": 100.0}}``; null entries are left out.

    Raises:
        ConfigError: if a setting is not one of guess, lower, upper, fixed, or its value is not a number.
    """
    return {name: settings for name, settings in _leaves(parameters, "") if settings}


def fit_settings(settings: Settings) -> FitSettings:
    """``estimator`` as ``FitSettings``.

    Raises:
        ConfigError: if a key or value is not allowed.
    """
    return settings.section("estimator", FitSettings)


def _leaves(node: Mapping[str, Any], path: str) -> Iterator[tuple[str, dict[str, float]]]:
    if path and MARK in node:
        return
    if path and any(key in ADJUSTABLE for key in node):
        for key in node:
            if key not in ADJUSTABLE:
                raise ConfigError(unknown(f"setting of parameter {path}", key, ADJUSTABLE))
        yield path, {k: _number(path, k, v) for k, v in node.items() if v is not None}
        return
    for key, below in node.items():
        name = f"{path}.{key}" if path else str(key)
        if below is None:
            continue
        if isinstance(below, Mapping):
            yield from _leaves(below, name)
        elif path:
            raise ConfigError(unknown(f"setting of parameter {path}", str(key), ADJUSTABLE))
        else:
            raise ConfigError(f"parameters.{name} is {below!r}: say which of {', '.join(ADJUSTABLE)} that is")


def _ownable(plant: Plant, effects: list[Effect]) -> set[str]:
    """The names of all parameters that the plant could have with any of ``effects`` at any port."""
    names = {p.name for p in plant.parameters} | {
        f"{p.name}.epsilon" for p in plant.ports if p.kind == "effort"
    }
    for effect in effects:
        for port in plant.ports:
            if port.kind == effect.kind:
                names |= {f"{port.name}.{effect.id}.{p.name}" for p in effect.parameters}
    return names


def _number(path: str, key: str, value: Any) -> float:
    """A setting of a parameter: a number, and where it is no bound a finite one."""
    where = f"parameters.{path}.{key}"
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        raise ConfigError(f"{where} is {shortened(repr(value), 60)}: too large a number")
    if isinstance(value, bool) or not isinstance(value, (int, float)) or math.isnan(value):
        raise ConfigError(f"{where} is {value!r}: must be a number")
    if key in ("guess", "fixed") and not math.isfinite(value):
        raise ConfigError(f"{where} is {value!r}: must be finite")
    return float(value)
