"""The section ``parameters`` of a config: nested mappings of settings, by the names of parameters."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping
from typing import Any

from hybridid.model.compose import ADJUSTABLE
from hybridid.naming import shortened
from pipelines.shared.by_record import MARK
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, unknown

BY = "by"
"""Setting of a parameter: by what it differs."""
SETTINGS = (*ADJUSTABLE, BY)
"""What a config may say of a parameter."""


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


def adjustments(parameters: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """Nested ``parameters`` as ``{"carriage.viscous.f_v": {"lower": 100.0}}``; null entries are left out.

    Raises:
        ConfigError: if a setting is not one of guess, lower, upper, fixed, or its value is not a number.
    """
    return {name: settings for name, settings in _leaves(parameters, "") if settings}


def asked_in(parameters: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    """Each parameter with a setting ``by`` in nested ``parameters``, and that setting; null is none."""
    for key, below in parameters.items():
        if key == BY and path:
            if below is not None:
                yield path, below
        elif isinstance(below, Mapping):
            yield from asked_in(below, f"{path}.{key}" if path else str(key))


def _unfolded(given: Mapping[str, Any], into: dict[str, Any], path: str = "") -> None:
    """Put ``given`` ``into`` nested mappings, with dotted keys taken apart."""
    for key, value in given.items():
        name, _, rest = str(key).partition(".")
        value = {rest: value} if rest else value
        if name == BY and path and not rest and into.get(name) is None:
            into[name] = value  # the names of groups are no paths
            continue
        before = into.get(name)
        joined = isinstance(before, dict) and isinstance(value, Mapping)
        if not (joined or before is None or value is None):
            raise ConfigError(f"parameters.{path}{name} is given twice: {before!r} and {value!r}")
        if isinstance(value, Mapping):
            into[name] = before or {}
            _unfolded(value, into[name], f"{path}{name}.")
        elif before is None:
            into[name] = value


def _leaves(node: Mapping[str, Any], path: str) -> Iterator[tuple[str, dict[str, float]]]:
    if path and MARK in node:
        return
    if path and any(key in SETTINGS for key in node):
        for key in node:
            if key not in SETTINGS:
                raise ConfigError(unknown(f"setting of parameter {path}", key, SETTINGS))
        yield path, {k: _number(path, k, v) for k, v in node.items() if v is not None and k != BY}
        return
    for key, below in node.items():
        name = f"{path}.{key}" if path else str(key)
        if below is None:
            continue
        if isinstance(below, Mapping):
            yield from _leaves(below, name)
        elif path:
            no_setting = unknown(f"setting of parameter {path}", str(key), SETTINGS)
            raise ConfigError(f"{no_setting}; of a parameter, parameters.{name}.fixed or .guess")
        else:
            raise ConfigError(f"parameters.{name} is {below!r}: say which of {', '.join(ADJUSTABLE)} that is")


def _number(path: str, key: str, value: Any) -> float:
    """A setting of a parameter: a number, and where it is no bound a finite one."""
    where = f"parameters.{path}.{key}"
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        raise ConfigError(f"{where} is {shortened(repr(value), 60)}: too large a number")
    if key == "fixed" and value is False:
        raise ConfigError(f"{where} is false: bounds let it be estimated, {where[:-6]}.lower or .upper")
    if isinstance(value, bool) or not isinstance(value, (int, float)) or math.isnan(value):
        raise ConfigError(f"{where} is {value!r}: must be a number")
    if key in ("guess", "fixed") and not math.isfinite(value):
        raise ConfigError(f"{where} is {value!r}: must be finite")
    return float(value)
