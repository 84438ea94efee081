"""A sweep's points: configs with nothing left to choose. Lists that make a grid are taken apart here."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from pipelines.shared.config import Settings, digest, digest_of
from pipelines.shared.sources import sources_of
from pipelines.shared.tree import tree_of

SEEDS = "residual.seeds"
GRIDS: Mapping[str, tuple[str, ...]] = {"narx": ("depth", "width", "seeds"), "rbf": ("nodes", "horizons")}
"""Keys of each kind of network whose lists are grids."""
_STAYS_A_LIST = ("horizons",)  # [null] is the whole record, null the gray box' own horizon
_SHARED = ("rig", "data", "records", "signals", "preprocess", "channels", "fit")
_JUDGED_BY = ("kind", "outputs", "blocks", "held_out", "folds", "initial_state")


@dataclass(frozen=True, eq=False)
class Point:
    """One config of a sweep; ``at`` are its coordinates, value by config key."""

    settings: Settings
    at: Mapping[str, Any]

    @cached_property
    def key(self) -> str:
        """Equal for equal models."""
        return digest(self.settings)

    @property
    def name(self) -> str:
        """The coordinates as one would type them."""
        return " ".join(f"{key}={spelt(value)}" for key, value in self.at.items())

    @property
    def is_traced(self) -> bool:
        """Whether what its model lacks is asked for."""
        return self.settings.get("sweep.stage") == "trace"

    @property
    def kind(self) -> str | None:
        """Of its network; None without one. A trace takes no network."""
        kind = None if self.is_traced else self.settings.get("residual.kind")
        return None if kind is None else str(kind)

    @property
    def last(self) -> str:
        """The stage whose result the sweep reads. A NARX network's has all scores already."""
        if self.is_traced:
            return "trace"
        return "residual" if self.kind == "narx" else "validate"

    @cached_property
    def gray(self) -> Settings:
        """The same without a network: points that share it share preprocess and fit."""
        return replace(self.settings, config={**self.settings.config, "residual": None})

    @cached_property
    def tree(self) -> Path:
        """Where its results lie: that of the same config run alone."""
        return tree_of(self.settings, self.simulated)

    @cached_property
    def gray_tree(self) -> Path:
        return tree_of(self.gray, self.simulated)

    @cached_property
    def simulated(self) -> bool:
        """Whether a virtual rig stands in for its records."""
        return sources_of(self.settings).simulated

    @cached_property
    def judged_on(self) -> str:
        """Equal for points whose held-out errors are of the same samples of the same records."""
        residual = self.settings.get("residual") or {}
        parts = [self.settings.case, self.settings.part(_SHARED), [residual.get(k) for k in _JUDGED_BY]]
        return digest_of(parts)[:8]

    def plain(self) -> dict[str, Any]:
        """As JSON takes it."""
        folders = [str(folder.resolve()) for folder in self.settings.folders]
        return {
            "case": self.settings.case,
            "config": dict(self.settings.config),
            "folders": folders,
            "at": dict(self.at),
        }

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Point:
        """What ``plain`` gave."""
        folders = tuple(Path(folder) for folder in data["folders"])
        return cls(Settings(data["case"], data["config"], folders, in_sweep=True), data["at"])


def spelt(value: Any) -> str:
    """A value as Hydra reads it."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, list):
        return f"[{','.join(map(spelt, value))}]"
    if isinstance(value, Mapping):
        return f"{{{','.join(f'{key}:{spelt(below)}' for key, below in value.items())}}}"
    return str(value)


def expanded(configs: Sequence[tuple[Settings, Mapping[str, Any]]]) -> list[Point]:
    """Every point of the configs, each with the coordinates it has already; equal ones once."""
    points: dict[tuple[str, str], Point] = {}
    for settings, at in configs:
        for point in _of_grid(settings, at):
            points.setdefault((point.settings.case, point.key), point)
    return list(points.values())


def axes_of(points: Sequence[Point]) -> list[str]:
    """The coordinates in which the points differ, seeds last."""
    keys = list(dict.fromkeys(key for point in points for key in point.at))
    several = [key for key in keys if len({spelt(point.at.get(key)) for point in points}) > 1]
    return sorted(several, key=lambda key: key == SEEDS)


def _traced_alone(settings: Settings) -> Settings:
    """With a trace of one process: many points are traced side by side."""
    trace = dict(settings.get("trace") or {})
    config = {**settings.config, "trace": {**trace, "processes": trace.get("processes") or 1}}
    return replace(settings, config=config, in_sweep=True)


def _of_grid(settings: Settings, at: Mapping[str, Any]) -> Iterator[Point]:
    """A point for each combination of the lists that make a grid; of a trace the config as it is."""
    if settings.get("sweep.stage") == "trace":
        yield Point(_traced_alone(settings), at)
        return
    residual = settings.get("residual") or {}
    names = [name for name in GRIDS.get(str(residual.get("kind")), ()) if residual.get(name) is not None]
    lists = [given if isinstance(given, list) else [given] for given in (residual[name] for name in names)]
    for values in itertools.product(*lists):
        chosen = {
            name: [value] if name in _STAYS_A_LIST else value
            for name, value in zip(names, values, strict=True)
        }
        if residual.get("kind") == "rbf":
            chosen["judged"] = True
        config = deepcopy(dict(settings.config))
        if chosen:
            config["residual"] = {**residual, **chosen}
        where = {**at, **{f"residual.{name}": value for name, value in chosen.items()}}
        yield Point(replace(settings, config=config, in_sweep=True), where)
