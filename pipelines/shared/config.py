"""The configuration of a run as plain data: checks of its names, its digest, its keys in dotted form."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from hybridid.plain import build
from hybridid.settings import keys
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.secrets import moved_to_environment
from pipelines.shared.sections.known import KEYS, SECTIONS
from pipelines.shared.sections.residual import KINDS as NETWORKS
from pipelines.shared.sections.stages import CaseSection, LoneKeys, MLflowSection, PathsSection

T = TypeVar("T")

# The keys that a model depends on: runs with the same values here share a run tree.
MODELLING = (
    "plant", "rig", "data", "records", "signals", "preprocess", "channels", "effects", "parameters",
    "estimator", "fit", "residual",
)  # fmt: skip


@dataclass(frozen=True)
class Settings:
    """A case's name, its resolved config as plain containers, the user's own folders, and the ``words`` of
    the command as they were typed (empty in a sweep).

    The password of ``mlflow.tracking_uri`` goes to the environment: ``config`` never holds it.

    Raises:
        ConfigError: if a key is not in ``KEYS``, or a key of a section does not belong to it or has a value
            that is not allowed, whether or not the command at hand reads that section.
    """

    case: str
    config: Mapping[str, Any]
    folders: tuple[Path, ...] = ()
    in_sweep: bool = False
    words: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "config", _spelled_out(moved_to_environment(self.config)))
        for key, value in self.config.items():
            if key == "case" and isinstance(value, Mapping) and set(value) - set(keys(CaseSection)):
                raise ConfigError(_case_key(self.case, value))
            if key not in KEYS:
                raise ConfigError(unknown("config key", key, KEYS))
            if key in SECTIONS and value is not None:
                build(SECTIONS[key], value, key, ConfigError)
        network = self.config.get("residual")
        if isinstance(network, Mapping) and "kind" in network:
            build(_network(str(network["kind"])), network, "residual", ConfigError)
        _ = self.lone, self.mlflow, self.paths  # of these null stands for no section

    @property
    def lone(self) -> LoneKeys:
        """The keys that belong to no section."""
        given = {key: self.config[key] for key in keys(LoneKeys) if key in self.config}
        return build(LoneKeys, given, "", ConfigError)

    @property
    def mlflow(self) -> MLflowSection:
        """Whether and where runs are logged."""
        return self.section("mlflow", MLflowSection)

    @property
    def paths(self) -> PathsSection:
        """Where files lie."""
        return self.section("paths", PathsSection)

    @property
    def outputs(self) -> Path:
        """The folder of all run trees."""
        return Path(self.paths.outputs)

    def section(self, name: str, cls: type[T]) -> T:
        """The section ``name`` as ``cls``, which declares its keys.

        Raises:
            ConfigError: in one line for a key or a value that is not allowed.
        """
        return build(cls, self.get(name, {}), name, ConfigError)

    def __getitem__(self, key: str) -> Any:
        """The value at a dotted key.

        Raises:
            ConfigError: if the config lacks it.
        """
        value: Any = self.config
        for part in key.split("."):
            if not isinstance(value, Mapping) or part not in value:
                raise ConfigError(f"case {self.case}: the config lacks {key}")
            value = value[part]
        return value

    def get(self, key: str, default: Any = None) -> Any:
        """The value at a dotted key, or ``default`` where it is missing or null."""
        try:
            value = self[key]
        except ConfigError:
            return default
        return default if value is None else value

    def part(self, keys: Sequence[str]) -> dict[str, Any]:
        """The config below ``keys`` as flat dotted keys."""
        return flat({key: self.get(key) for key in keys})


def digest(settings: Settings) -> str:
    """Eight hexadecimal digits of the modelling config."""
    return digest_of([settings.case, settings.part(MODELLING)])[:8]


def digest_of(content: Any) -> str:
    """SHA-256 of plain data, in which the order of keys does not count."""
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()


def flat(value: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """``{"a": {"b": 1}}`` as ``{"a.b": 1}``; lists and empty mappings stay whole."""
    result: dict[str, Any] = {}
    for key, below in value.items():
        name = f"{prefix}{key}"
        if isinstance(below, Mapping) and below:
            result.update(flat(below, f"{name}."))
        else:
            result[name] = below
    return result


def _spelled_out(config: Mapping[str, Any]) -> Mapping[str, Any]:
    """``config`` with ``controller: LAW`` as the section that it is short for."""
    law = config.get("controller")
    return {**config, "controller": {"law": law}} if isinstance(law, str) else config


def _network(kind: str) -> type:
    if kind not in NETWORKS:
        raise ConfigError(unknown("residual.kind", kind, NETWORKS))
    return NETWORKS[kind]


def _case_key(case: str, value: Mapping[str, Any]) -> str:
    strange = sorted(set(value) - set(keys(CaseSection)))[0]
    if strange in KEYS:
        return (
            f"case {case}: its file must begin with '# @package _global_'; without it {strange} is read as a "
            f"key below case"
        )
    return unknown("config key below case", strange, keys(CaseSection))
