"""``parameters.NAME.by``: parameters that are estimated for each record, or for each group of records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hybridid.model.groups import of_group
from hybridid.naming import listed
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.parameters import BY
from pipelines.shared.sources import fitted_records, sources_of

RECORD = "record"
"""Each fitted record has a value of its own."""
_ALLOWED = "give record, or groups of records, as in {cold: [first, second], warm: [third]}"


@dataclass(frozen=True)
class Grouping:
    """The groups of records, by name with their records, among which ``parameter`` differs.

    ``own``: each record is a group of its own, and those that are not fitted belong to none.
    """

    parameter: str
    groups: Mapping[str, tuple[str, ...]]
    own: bool

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the groups."""
        return tuple(self.groups)

    @property
    def setting(self) -> Any:
        """The setting ``by`` that says the same without the records that are fitted."""
        return list(self.groups) if self.own else {name: list(some) for name, some in self.groups.items()}

    def has(self, record: str) -> bool:
        """Whether the record belongs to a group."""
        return any(record in some for some in self.groups.values())

    def weights(self, record: str) -> dict[str, float]:
        """What each group's value counts in a record: 1 in its own; in one that has none, the mean counts."""
        mean = 1.0 / len(self.groups)
        return {
            of_group(self.parameter, name): float(record in some) if self.has(record) else mean
            for name, some in self.groups.items()
        }

    def check_fitted(self, records: Sequence[str], key: str) -> None:
        """Check that each group has one of the fitted ``records``, which ``key`` chooses.

        Raises:
            ConfigError: if not.
        """
        for name, some in self.groups.items():
            if not set(some) & set(records):
                raise ConfigError(
                    f"parameters.{self.parameter}.{BY}: of group {name} no record is fitted, so its value "
                    f"cannot be estimated; {key} chooses {listed(records)}"
                )


def groupings(settings: Settings, asked: Mapping[str, Any]) -> dict[str, Grouping]:
    """The groups of each parameter in ``asked``, the settings ``by``, by name.

    Without records (a model that is read from its file) only their form is checked.

    Raises:
        ConfigError: if a record is unknown, in two groups or, fitted or with groups of others, in none; if a
            group has no record that is fitted, or there is only one.
    """
    if not asked:
        return {}
    if settings.get("records") is None:
        return {name: _grouping(name, by, ()) for name, by in asked.items()}
    found = sources_of(settings).found
    every = [source.name for source in found]
    fitted = [source.name for source in fitted_records(found, settings)]
    known = [str(name) for name in settings["records"]]
    result = {}
    for name, by in asked.items():
        one = _grouping(name, by, fitted)
        _check(one, known, fitted if one.own else every, fitted)
        result[name] = one
    return result


def _grouping(name: str, by: Any, fitted: Sequence[str]) -> Grouping:
    """The setting ``by`` of parameter ``name`` as groups."""
    where = f"parameters.{name}.{BY}"
    if by == RECORD:
        return Grouping(name, {record: (record,) for record in fitted}, own=True)
    if isinstance(by, list) and by and all(isinstance(record, str) for record in by):
        return Grouping(name, {record: (record,) for record in by}, own=True)
    if not isinstance(by, Mapping) or not by:
        raise ConfigError(f"{where} is {by!r}: {_ALLOWED}")
    groups = {}
    for group, some in by.items():
        records = [some] if isinstance(some, str) else some
        if not isinstance(records, list) or not records or not all(isinstance(one, str) for one in records):
            raise ConfigError(f"{where}.{group} is {some!r}: give a list of records, as in [first, second]")
        groups[str(group)] = tuple(records)
    return Grouping(name, groups, own=False)


def _check(one: Grouping, known: Sequence[str], belong: Sequence[str], fitted: Sequence[str]) -> None:
    """Check ``one`` against the records: all that ``belong`` to a group must be in it."""
    where = f"parameters.{one.parameter}.{BY}"
    home: dict[str, str] = {}
    for group, records in one.groups.items():
        for record in records:
            if record not in known:
                raise ConfigError(unknown(f"record in {where}:", record, known))
            if record in home:
                raise ConfigError(
                    f"{where}: record {record} is in group {home[record]} and in group {group}; "
                    "a record belongs to one group"
                )
            home[record] = group
    left = [record for record in belong if record not in home]
    if left:
        raise ConfigError(f"{where}: no group has record {listed(left)}; every record belongs to one")
    one.check_fitted(fitted, "fit.records")
    if len(one.groups) < 2:
        raise ConfigError(
            f"{where}: {listed(list(one.groups))} is the only group, so nothing can differ; "
            f"fit.records chooses {listed(fitted)}"
        )
