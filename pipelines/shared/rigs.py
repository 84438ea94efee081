"""The case's virtual rig as ``rig:`` configures it: which, with what noise, and what the truth is."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any

from hybridid.rigs.laws import RigError
from hybridid.rigs.rig import Rig
from hybridid.rigs.truth import planted_laws
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.imports import named

KEYS = ("path", "seed", "duration", "truth", "planted")


def rig_of(given: Any) -> Rig:
    """The rig at the import path ``path``, an instance or a class to make one of, with another truth if
    ``truth`` (numbers by name) or ``planted`` (a list of laws) says so; null leaves each as the rig has it.

    Raises:
        ConfigError: in one line for an unknown key, rig, number, law, port or parameter.
    """
    if not isinstance(given, Mapping):
        raise ConfigError(f"rig is {given!r}: give {', '.join(KEYS)}")
    for key in given:
        if key not in KEYS:
            raise ConfigError(unknown("config key below rig", key, KEYS))
    rig = named(given.get("path"), "rig.path")
    rig = rig() if inspect.isclass(rig) else rig
    if not isinstance(rig, Rig):
        raise ConfigError(
            f"rig.path {given.get('path')} is a {type(rig).__name__}, not a hybridid.rigs.rig.Rig"
        )
    truth, planted = given.get("truth"), given.get("planted")
    if truth is None and planted is None:
        return rig
    try:
        return rig.with_truth(truth or {}, None if planted is None else planted_laws(planted, rig.ports))
    except RigError as error:
        raise ConfigError(str(error)) from error
