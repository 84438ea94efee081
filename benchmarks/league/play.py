"""The league before every player: ours, the oracle and the rivals."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

from benchmarks.answers import ORACLE, League, version_of
from benchmarks.league import ours, rivals
from benchmarks.league.machines import records_of
from benchmarks.league.scenario import CATEGORIES, Scenario

PLAYERS = (ORACLE, ours.NAME, "regression", "regression_own_cutoff", "regression_memory", "pysindy")


def version(player: str) -> str:
    """SHA-256 of the code that decides what ``player`` answers, its scenarios' records included."""
    return version_of(ours if player in (ORACLE, ours.NAME) else rivals)


def chosen(
    scenarios: Iterable[Scenario], only: Sequence[str] = (), match: str = "", limit: int | None = None
) -> list[Scenario]:
    """Those of the categories ``only`` (empty: all) whose key contains ``match``, at most ``limit`` of each
    category, evenly spread."""
    matching = [s for s in scenarios if (not only or s.category in only) and match in s.key]
    if limit is None:
        return matching
    kept: list[Scenario] = []
    for category in CATEGORIES:
        part = [s for s in matching if s.category == category]
        count = min(limit, len(part))
        kept += [part[k * len(part) // count] for k in range(count)]
    return kept


def _begun(scenario: Scenario):
    return partial(_answered, scenario, records_of(scenario))


def _answered(scenario: Scenario, records, player: str, most_effects: int) -> dict[str, Any] | None:
    if player == ORACLE:
        found = ours.consult(scenario, records)
        return None if found is None else {**vars(found), "detectable": found.detectable}
    plays: Mapping[str, Callable[..., Any]] = {
        "regression": rivals.regression,
        "regression_own_cutoff": rivals.own_cutoff,
        "regression_memory": rivals.with_memory,
        "pysindy": rivals.pysindy,
    }
    if player == ours.NAME:
        return ours.play(scenario, records, most_effects).described()
    return plays[player](scenario, records).described()


LEAGUE = League("league", PLAYERS, version, _begun)
answer, known = LEAGUE.answer, LEAGUE.known
