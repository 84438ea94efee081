"""The plain configuration a stage works with: checked names, a digest, flat keys."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipelines.shared.errors import ConfigError, unknown

# What may stand in a config, section by section; None: the case decides what stands below.
SECTIONS: Mapping[str, tuple[str, ...] | None] = {
    "case": ("title", "source"),
    "archive": ("name", "url"),
    "plant": None,
    "rig": None,
    "data": None,
    "records": None,
    "signals": None,
    "effects": None,
    "parameters": None,
    "preprocess": ("steps",),
    "estimator": None,
    "fit": ("records",),
    "residual": None,
    "validate": ("records", "views", "horizon", "initial_state", "lags"),
    "plot": ("formats",),
    "trace": (
        "records",
        "held_out",
        "horizon",
        "effects",
        "extra_effects",
        "ports",
        "alpha",
        "worth",
        "tie",
        "stands_in",
        "most_effects",
        "processes",
    ),
    "sweep": ("stack", "processes", "job"),
    "tune": None,
    "model": None,
    "paths": ("data", "outputs"),
    "out": None,
    "force": None,
    "mlflow": ("enabled", "tracking_uri", "experiment", "patience"),
    "port": None,
}

# What makes a model what it is: runs that agree in these share a tree.
MODELLING = (
    "plant", "rig", "data", "records", "signals", "preprocess", "effects", "parameters", "estimator", "fit",
    "residual",
)  # fmt: skip


@dataclass(frozen=True)
class Settings:
    """A case's name, its resolved config as plain containers, and the user's own folders.

    Raises:
        ConfigError: if a key is none of those in ``SECTIONS``.
    """

    case: str
    config: Mapping[str, Any]
    folders: tuple[Path, ...] = ()
    in_sweep: bool = False

    def __post_init__(self) -> None:
        for key, value in self.config.items():
            if key == "case" and isinstance(value, Mapping) and set(value) - set(SECTIONS["case"] or ()):
                raise ConfigError(_case_key(self.case, value))
            if key not in SECTIONS:
                raise ConfigError(unknown("config key", key, SECTIONS))
            _check_section(key, value, SECTIONS[key])

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
    text = json.dumps([settings.case, settings.part(MODELLING)], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:8]


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


def _check_section(name: str, value: Any, allowed: tuple[str, ...] | None) -> None:
    if allowed is None:
        return
    if not isinstance(value, Mapping):
        raise ConfigError(f"{name} must hold {', '.join(allowed)}; it is {value!r}")
    for key in value:
        if key not in allowed:
            raise ConfigError(unknown(f"config key below {name}", key, allowed))


def _case_key(case: str, value: Mapping[str, Any]) -> str:
    strange = sorted(set(value) - set(SECTIONS["case"] or ()))[0]
    if strange in SECTIONS:
        return (
            f"case {case}: its file must begin with '# @package _global_', or {strange} is no key of its own"
        )
    return unknown("config key below case", strange, SECTIONS["case"] or ())
