"""The case's virtual rig as the section ``rig`` configures it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hybridid.plain import build
from hybridid.rigs.laws import RigError
from hybridid.rigs.rig import Rig
from hybridid.rigs.truth import planted_laws
from pipelines.shared.errors import ConfigError
from pipelines.shared.imports import made
from pipelines.shared.sections.stages import RigSection


def rig_of(given: Mapping[str, Any]) -> Rig:
    """The rig of the section ``rig``: ``path`` is the import path of an instance or of a class.

    ``truth`` (numbers by name) replaces true parameter values and ``planted`` (a list of laws) the added
    physics; null keeps those of the rig.

    Raises:
        ConfigError: in one line for an unknown key, rig, number, law, port or parameter.
    """
    section = build(RigSection, given, "rig", ConfigError)
    rig: Rig = made(section.path, "rig.path", Rig, (RigError,))
    truth, planted = section.truth, section.planted
    if truth is None and planted is None:
        return rig
    try:
        return rig.with_truth(truth or {}, None if planted is None else planted_laws(planted, rig.ports))
    except RigError as error:
        raise ConfigError(str(error)) from error
