"""Every scenario before every player, and what came of it: JSON lines that a later run goes on with.

A line is one player's answer to one scenario under one version: the digest of the scenario and of all code
that decides the answer. A line of another version is not used.
"""

from __future__ import annotations

import hashlib
import json
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.league import ours, rivals
from benchmarks.league.machines import records_of
from benchmarks.league.scenario import CATEGORIES, Scenario
from pipelines.shared.pool import Lost, side_by_side
from pipelines.shared.source_code import code_of
from pipelines.shared.watch import Watcher

ORACLE = "oracle"
PLAYERS = (ORACLE, ours.NAME, "regression", "regression_own_cutoff", "regression_memory", "pysindy")
Line = Mapping[str, Any]


def version(player: str) -> str:
    """SHA-256 of the code that decides what ``player`` answers, its scenarios' records included."""
    code = code_of((ours if player in (ORACLE, ours.NAME) else rivals).__name__)
    return hashlib.sha256(json.dumps(code).encode()).hexdigest()[:16]


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


def answer(scenario: Scenario, players: Sequence[str], most_effects: int = 2) -> list[dict[str, Any]]:
    """One line a player. What a player raises is its answer, and the league goes on and says so."""
    records = records_of(scenario)
    lines = []
    for player in players:
        line = _line(scenario, player)
        try:
            line["answer"] = _answered(scenario, records, player, most_effects)
        except Exception:
            line["failure"] = traceback.format_exc(limit=-3)
        lines.append(line)
    return lines


def _line(scenario: Scenario, player: str) -> dict[str, Any]:
    """A line without its answer."""
    return {
        "key": scenario.key,
        "player": player,
        "digest": scenario.digest(version(player)),
        "scenario": {**scenario.described(), "truth": scenario.truth},
    }


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


def known(file: Path, scenarios: Iterable[Scenario], players: Sequence[str]) -> dict[tuple[str, str], Line]:
    """Lines of ``file`` that still hold, by (key, player); an unfinished last line is passed over."""
    wanted = {(s.key, p): s.digest(version(p)) for s in scenarios for p in players}
    found: dict[tuple[str, str], Line] = {}
    for text in file.read_text(encoding="utf-8").splitlines() if file.exists() else ():
        try:
            line = json.loads(text)
        except json.JSONDecodeError:
            continue
        key = (line["key"], line["player"])
        if wanted.get(key) == line["digest"] and "failure" not in line:
            found[key] = line
    return found


def played(
    scenarios: Sequence[Scenario], players: Sequence[str], file: Path, processes: int, most_effects: int
) -> Iterator[list[Line]]:
    """Plays what ``file`` does not hold yet and appends it as it comes; yields the lines of each scenario."""
    there = known(file, scenarios, players)
    asked = {s.key: (s, [p for p in players if (s.key, p) not in there], most_effects) for s in scenarios}
    todo = {key: given for key, given in asked.items() if given[1]}
    file.parent.mkdir(parents=True, exist_ok=True)
    for key, lines in side_by_side(_answers, todo, processes):
        if isinstance(lines, Lost):
            scenario, missing, _ = todo[key]
            lines = [{**_line(scenario, player), "failure": lines.reason} for player in missing]
        with file.open("a", encoding="utf-8") as out:
            out.writelines(json.dumps(line, default=float) + "\n" for line in lines)
        yield lines


def _answers(given: tuple[Scenario, Sequence[str], int], watcher: Watcher) -> list[dict[str, Any]]:
    return answer(*given)
