"""``channels`` of a config: which auxiliary signals of the records the effects may see."""

from __future__ import annotations

from collections.abc import Mapping

from hybridid.declarations import Signal
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError


def channels_of(settings: Settings) -> tuple[Signal, ...]:
    """Each channel with its unit, in the order of the config.

    Raises:
        ConfigError: if ``channels`` is anything else than names with units.
    """
    given = settings.get("channels", {})
    if not isinstance(given, Mapping) or not all(isinstance(unit, str) for unit in given.values()):
        raise ConfigError(f"channels is {given!r}: give names with units, as in {{temperature: °C}}")
    return tuple(Signal(str(name), unit) for name, unit in given.items())
