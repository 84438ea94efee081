"""The section ``tune`` of a config: what is varied, how far, and how long."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any

from pipelines.shared.config import Settings, digest
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.sections.searches import TuneSection

if TYPE_CHECKING:
    from optuna.distributions import BaseDistribution

ALLOWED = (
    "depth", "width", "orders.error", "orders.inputs", "orders.gray", "learning_rate", "weight_decay",
    "batch", "patience", "increment",
)  # fmt: skip
"""Keys below ``residual`` that may be varied: every trial is judged on the same blocks in the same way."""
_RANGE = ("low", "high", "log", "step")
Value = bool | int | float | str


@dataclass(frozen=True)
class Range:
    """Numbers from ``low`` to ``high``, integers if both are; ``log`` searches on a logarithmic scale."""

    low: float
    high: float
    log: bool = False
    step: float | None = None

    @property
    def ends(self) -> tuple[Value, Value]:
        """The lowest and the highest value."""
        return self.low, self.high

    def distribution(self) -> BaseDistribution:
        """The range as Optuna's distribution."""
        from optuna.distributions import FloatDistribution, IntDistribution

        if isinstance(self.low, int) and isinstance(self.high, int):
            return IntDistribution(self.low, self.high, log=self.log, step=int(self.step or 1))
        return FloatDistribution(self.low, self.high, log=self.log, step=self.step)


@dataclass(frozen=True)
class Choice:
    """One of some values."""

    values: tuple[Value, ...]

    @property
    def ends(self) -> tuple[Value, Value]:
        """The first and the last value."""
        return self.values[0], self.values[-1]

    def distribution(self) -> BaseDistribution:
        """The choice as Optuna's distribution."""
        from optuna.distributions import CategoricalDistribution

        return CategoricalDistribution(self.values)


@dataclass(frozen=True)
class TuneRequest(TuneSection):
    """The section ``tune``, its ``space`` by dotted config key. ``trials`` are to be done in all, by whoever
    takes part; ``seconds`` bounds this command alone."""

    space: Mapping[str, Range | Choice] = field(default_factory=dict)

    @classmethod
    def of(cls, settings: Settings) -> TuneRequest:
        """
        Raises:
            ConfigError: if a key or value is not allowed, or there is nothing to vary.
        """
        if settings.get("residual.kind") != "narx":
            raise ConfigError("tune searches for NARX networks: choose residual=narx; sweep compares others")
        section = settings.section("tune", TuneSection)
        space = dict(_axes(section.space or {}, "tune.space"))
        if not space:
            raise ConfigError("tune.space is empty: give a key at least, as in tune.space.residual.width")
        for key in space:
            _check_key(key, settings)
        rest = {f.name: getattr(section, f.name) for f in fields(section) if f.name != "space"}
        return cls(space, **rest)

    def distributions(self) -> dict[str, BaseDistribution]:
        """Optuna's distribution of each varied key."""
        return {key: axis.distribution() for key, axis in self.space.items()}

    def corners(self) -> Iterator[dict[str, Value]]:
        """The config with every key at its lowest or first, then highest or last value."""
        yield {key: axis.ends[0] for key, axis in self.space.items()}
        yield {key: axis.ends[1] for key, axis in self.space.items()}


def with_values(settings: Settings, values: Mapping[str, Value]) -> Settings:
    """``settings`` with dotted keys changed."""
    config = deepcopy(dict(settings.config))
    for key, value in values.items():
        *above, last = key.split(".")
        node = config
        for part in above:
            node = node[part]
        node[last] = value
    return replace(settings, config=config)


def gray_settings(settings: Settings) -> Settings:
    """What ``hybridid fit`` would run with: the gray box is the same for every trial."""
    config = {k: v for k, v in settings.config.items() if k not in ("residual", "tune", "out")}
    return replace(settings, config=config)


def study_digest(settings: Settings, request: TuneRequest, data: Mapping[str, str]) -> str:
    """Equal if trials may be compared: one model, data, network and space, however long the search."""
    low = next(request.corners())
    node = {"config": digest(with_values(settings, low)), "space": str(sorted(request.space.items()))}
    return digest(Settings(settings.case, {"residual": {**node, "data": dict(data)}}))


def _axes(node: Any, prefix: str) -> Iterator[tuple[str, Range | Choice]]:
    """The leaves of ``tune.space``, by the config key that each varies."""
    key = prefix.removeprefix("tune.space").lstrip(".")
    if isinstance(node, (list, tuple)):
        if len(node) < 2 or not all(isinstance(v, bool | int | float | str) for v in node):
            raise ConfigError(f"{prefix} is {list(node)}: a list holds at least two values to choose from")
        yield key, Choice(tuple(node))
    elif isinstance(node, Mapping) and ("low" in node or "high" in node):
        yield key, _range(node, prefix)
    elif isinstance(node, Mapping):
        for name, below in node.items():
            if below is not None:  # null: this key is not varied
                yield from _axes(below, f"{prefix}.{name}")
    else:
        raise ConfigError(f"{prefix} is {node!r}: give {{low: 1, high: 8}}, with log: true if so, or a list")


def _range(node: Mapping[str, Any], prefix: str) -> Range:
    for name in node:
        if name not in _RANGE:
            raise ConfigError(unknown(f"key below {prefix}", str(name), _RANGE))
    for name in ("low", "high"):
        value = node.get(name)
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise ConfigError(f"{prefix}.{name} is {value!r}: must be a number")
    found = Range(**node)
    if not found.low < found.high:
        raise ConfigError(f"{prefix}: low is {found.low} and high {found.high}; low must be below high")
    if found.log and (found.low <= 0 or found.step is not None):
        raise ConfigError(f"{prefix}: with log, low must be positive and there is no step")
    if found.step is not None and not found.step > 0:
        raise ConfigError(f"{prefix}.step is {found.step}: must be positive")
    return found


def _check_key(key: str, settings: Settings) -> None:
    section, _, below = key.partition(".")
    if section != "residual" or below not in ALLOWED:
        raise ConfigError(unknown("key in tune.space:", key, [f"residual.{name}" for name in ALLOWED]))
    settings[key]
