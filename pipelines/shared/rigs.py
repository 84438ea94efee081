"""The case's virtual rig as ``rig:`` configures it: which, with what noise, and what the truth is."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any

from hybridid.plain import build
from hybridid.rigs.laws import RigError
from hybridid.rigs.rig import Rig
from hybridid.rigs.truth import planted_laws
from pipelines.shared.errors import ConfigError
from pipelines.shared.imports import named
from pipelines.shared.sections.stages import RigSection


def rig_of(given: Mapping[str, Any]) -> Rig:
    """The rig of the section ``rig``: at the import path ``path``, an instance or a class to make one of.

    ``truth`` (numbers by name) and ``planted`` (a list of laws) give it another truth; null leaves each as
    the rig has it.

    Raises:
        ConfigError: in one line for an unknown key, rig, number, law, port or parameter.
    """
    section = build(RigSection, given, "rig", ConfigError)
    rig = named(section.path, "rig.path")
    rig = rig() if inspect.isclass(rig) else rig
    if not isinstance(rig, Rig):
        raise ConfigError(f"rig.path {section.path} is a {type(rig).__name__}, not a hybridid.rigs.rig.Rig")
    truth, planted = section.truth, section.planted
    if truth is None and planted is None:
        return rig
    try:
        return rig.with_truth(truth or {}, None if planted is None else planted_laws(planted, rig.ports))
    except RigError as error:
        raise ConfigError(str(error)) from error
