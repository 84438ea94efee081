"""``controller`` of a config: the control law that ran the machine, as a ``Loop``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hybridid.controllers.controller import Controller
from hybridid.controllers.library import LAWS
from hybridid.controllers.loop import Loop
from hybridid.declarations import Signal
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.imports import code_digests, made
from pipelines.shared.sections.stages import ControllerSection

KEY = "controller"


def controller_section(settings: Settings) -> ControllerSection | None:
    """The section ``controller``; None where the case has none."""
    return settings.section(KEY, ControllerSection) if settings.get(KEY) is not None else None


def loop_of(settings: Settings, inputs: Sequence[Signal], outputs: Sequence[Signal]) -> Loop | None:
    """The controller of the config around a plant with these signals; None where the case has none.

    Raises:
        ConfigError: if the law cannot be found, does not fit the plant, or a number is not allowed.
    """
    section = controller_section(settings)
    if section is None:
        return None
    try:
        loop = Loop(
            made(_path(section.law), KEY, Controller),
            _numbers(section.parameters),
            dict(section.references or {}),
            section.every or 0,
            -1 if section.delay is None else section.delay,
        )
        loop.check(inputs, outputs)
    except ConfigError:
        raise
    except ValueError as error:
        raise ConfigError(str(error)) from error
    return loop


def controller_code(settings: Settings) -> dict[str, str]:
    """Digests of the controller's code."""
    section = controller_section(settings)
    return code_digests([_path(section.law)]) if section else {}


def _path(law: str) -> str:
    """The import path of a law."""
    if ":" not in law and law not in LAWS:
        raise ConfigError(f"{unknown('controller', law, LAWS)}; your own is named by module:NAME")
    return LAWS.get(law, law)


def _numbers(given: Mapping[str, Any] | None) -> dict[str, float]:
    """The numbers of a law's parameters; null entries are left out."""
    return {str(name): float(value) for name, value in (given or {}).items() if value is not None}
