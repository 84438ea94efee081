"""``records.NAME.parameters``: parameters that are known, and differ from record to record."""

from __future__ import annotations

import math
from collections.abc import Mapping

from hybridid.naming import listed
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError

MARK = "by_record"
"""Setting of a parameter in the file of a model: each record gives its value."""


def parameters_by_record(settings: Settings) -> tuple[str, ...]:
    """The names of the parameters that every record gives.

    Raises:
        ConfigError: if a record gives something else than names with numbers, or not those that others give.
    """
    records = settings.get("records")
    if not isinstance(records, Mapping):
        return ()
    by_record = {str(name): _given(str(name), entry) for name, entry in records.items()}
    names = tuple(dict.fromkeys(name for given in by_record.values() for name in given))
    for record, given in by_record.items():
        missing = [name for name in names if name not in given]
        if missing:
            raise ConfigError(
                f"records.{record}.parameters: {listed(missing)} is missing, which other records give; "
                "a parameter is given by every record, or by none"
            )
    return names


def _given(record: str, entry: object) -> Mapping[str, float]:
    found = entry.get("parameters") if isinstance(entry, Mapping) else None
    if found is None:
        return {}
    if not isinstance(found, Mapping):
        raise ConfigError(
            f"records.{record}.parameters is {found!r}: give names with numbers, as in {{kp: 400}}"
        )
    for name, value in found.items():
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise ConfigError(f"records.{record}.parameters.{name} is {value!r}: must be a finite number")
    return found
