"""Every drawn scenario before the oracle and our trace: JSON lines that a later run goes on with.

A line holds one answer and the digest of its scenario and of all code that decides it. A line of other code
is not used.
"""

from __future__ import annotations

import hashlib
import json
import traceback
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from benchmarks.drawn import amount, oracle, ours
from benchmarks.drawn.draw import CATEGORIES, Draw
from benchmarks.drawn.scoring import ORACLE, Line
from pipelines.shared.pool import Lost, side_by_side
from pipelines.shared.source_code import code_of
from pipelines.shared.watch import Watcher

PLAYERS = (ORACLE, ours.NAME)


@cache
def version(player: str) -> str:
    """SHA-256 of the code that decides what ``player`` answers, its scenarios' records included."""
    decides = oracle if player == ORACLE else ours
    code = [code_of(module.__name__) for module in (amount, decides)]
    return hashlib.sha256(json.dumps(code).encode()).hexdigest()[:16]


def chosen(draws: Iterable[Draw], match: str = "", limit: int | None = None) -> list[Draw]:
    """Those whose key contains ``match``; at most ``limit``, evenly spread over the categories."""
    matching = [draw for draw in draws if match in draw.key]
    if limit is None or limit >= len(matching):
        return matching
    by_category = {c: [d for d in matching if d.category == c] for c in CATEGORIES}
    kept: list[Draw] = []
    while len(kept) < limit:
        kept += [part.pop(0) for part in by_category.values() if part]
    return kept[:limit]


def answer(draw: Draw, players: Sequence[str], most_effects: int = 2) -> list[dict[str, Any]]:
    """One line a player. What a player raises is its answer, and the league goes on and says so."""
    lines = []
    for player in players:
        line = _line(draw, player)
        try:
            line["answer"] = _answered(draw, player, most_effects)
        except Exception:
            line["failure"] = traceback.format_exc(limit=-3)
        lines.append(line)
    return lines


def _line(draw: Draw, player: str) -> dict[str, Any]:
    digest = draw.digest(version(player))
    return {"key": draw.key, "player": player, "digest": digest, "scenario": draw.described()}


def _answered(draw: Draw, player: str, most_effects: int) -> dict[str, Any]:
    if player == ORACLE:
        found = oracle.consult(draw)
        return {**vars(found), "detectable": found.detectable}
    return ours.play(draw, amount.records_of(draw), most_effects).described()


def known(file: Path, draws: Iterable[Draw], players: Sequence[str]) -> dict[tuple[str, str], Line]:
    """Lines of ``file`` that still hold, by (key, player); an unfinished last line is passed over."""
    wanted = {(d.key, p): d.digest(version(p)) for d in draws for p in players}
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
    draws: Sequence[Draw], players: Sequence[str], file: Path, processes: int, most_effects: int
) -> Iterator[list[Line]]:
    """Plays what ``file`` does not hold yet and appends it as it comes; yields the lines of each scenario."""
    there = known(file, draws, players)
    asked = {d.key: (d, [p for p in players if (d.key, p) not in there], most_effects) for d in draws}
    todo = {key: given for key, given in asked.items() if given[1]}
    file.parent.mkdir(parents=True, exist_ok=True)
    for key, lines in side_by_side(_answers, todo, processes):
        if isinstance(lines, Lost):
            draw, missing, _ = todo[key]
            lines = [{**_line(draw, player), "failure": lines.reason} for player in missing]
        with file.open("a", encoding="utf-8") as out:
            out.writelines(json.dumps(line, default=float) + "\n" for line in lines)
        yield lines


def _answers(given: tuple[Draw, Sequence[str], int], watcher: Watcher) -> list[dict[str, Any]]:
    return answer(*given)
