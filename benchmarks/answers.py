"""``League``: players answer scenarios, as JSON lines that a later run goes on with.

A line holds one player's answer to one scenario, and the digest of the scenario and of all code that decides
the answer. A line of another digest is not used.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from types import ModuleType
from typing import Any, Generic, Protocol, TypeVar

from pipelines.shared.pool import Lost, side_by_side
from pipelines.shared.source_code import code_of
from pipelines.shared.watch import Watcher

Line = Mapping[str, Any]
Answered = Callable[[str, int], Mapping[str, Any] | None]
"""One player's answer, by the player and the most effects that it may name."""
ORACLE = "oracle"


@cache
def version_of(*modules: ModuleType) -> str:
    """SHA-256 of all code that ``modules`` run."""
    code = [code_of(module.__name__) for module in modules]
    return hashlib.sha256(json.dumps(code).encode()).hexdigest()[:16]


class AnyScenario(Protocol):
    """What every league's scenario can say of itself; ``key`` is readable and unique."""

    @property
    def key(self) -> str: ...
    @property
    def category(self) -> str: ...
    def described(self) -> Mapping[str, Any]: ...


S = TypeVar("S", bound=AnyScenario)


def digest(scenario: AnyScenario, version: str) -> str:
    """SHA-256 of the scenario and of ``version``, whatever decides its outcome besides."""
    said = json.dumps([scenario.described(), version], sort_keys=True)
    return hashlib.sha256(said.encode()).hexdigest()[:16]


@dataclass(frozen=True)
class League(Generic[S]):
    """``players`` before scenarios of one kind; its functions must pickle.

    ``version(player)`` is the digest of the code that decides what the player answers. ``begun(scenario)``
    makes once what all players need. It returns ``answered(player, most_effects)``, which gives one player's
    answer.
    """

    name: str
    players: tuple[str, ...]
    version: Callable[[str], str]
    begun: Callable[[S], Answered]

    def line(self, scenario: S, player: str) -> dict[str, Any]:
        """A line without its answer."""
        return {
            "key": scenario.key,
            "player": player,
            "digest": digest(scenario, self.version(player)),
            "scenario": scenario.described(),
        }

    def answer(self, scenario: S, players: Sequence[str], most_effects: int = 2) -> list[dict[str, Any]]:
        """One line a player. What a player raises is its answer, and the league goes on and says so."""
        answered = self.begun(scenario)
        lines = []
        for player in players:
            line = self.line(scenario, player)
            try:
                line["answer"] = answered(player, most_effects)
            except Exception:
                line["failure"] = traceback.format_exc(limit=-3)
            lines.append(line)
        return lines

    def known(
        self, file: Path, scenarios: Iterable[S], players: Sequence[str]
    ) -> dict[tuple[str, str], Line]:
        """Lines of ``file`` that still hold, by (key, player)."""
        wanted = {(s.key, p): digest(s, self.version(p)) for s in scenarios for p in players}
        found: dict[tuple[str, str], Line] = {}
        for line in lines_of(file):
            key = (line["key"], line["player"])
            if wanted.get(key) == line["digest"] and "failure" not in line:
                found[key] = line
        return found

    def played(
        self, scenarios: Sequence[S], players: Sequence[str], file: Path, processes: int, most_effects: int
    ) -> Iterator[list[Line]]:
        """Plays what ``file`` does not hold yet and appends it as it comes; yields the lines of each
        scenario."""
        there = self.known(file, scenarios, players)
        asked = {
            s.key: (self, s, [p for p in players if (s.key, p) not in there], most_effects) for s in scenarios
        }
        todo = {key: given for key, given in asked.items() if given[2]}
        file.parent.mkdir(parents=True, exist_ok=True)
        for key, lines in side_by_side(_answers, todo, processes):
            if isinstance(lines, Lost):
                _, scenario, missing, _ = todo[key]
                lines = [{**self.line(scenario, player), "failure": lines.reason} for player in missing]
            append(file, lines)
            yield lines

    def conduct(
        self, scenarios: Sequence[S], asked: argparse.Namespace, report: Callable[[Sequence[Line], Path], str]
    ) -> int:
        """List ``scenarios``, or play what is missing of them, and print what ``report`` says of all answers.

        Returns 1 where a player failed, 2 where there is no scenario. ``asked`` is of ``parser``.
        """
        if not scenarios:
            print(f"{self.name}: no scenario matches {asked.match!r}; see --list")
            return 2
        if asked.list:
            width = max(len(s.category) for s in scenarios)
            print("\n".join(f"{s.category:{width}} {s.key}" for s in scenarios))
            return 0
        file = asked.out / "results.jsonl"
        failures = [] if asked.report else self._told(scenarios, asked, file)
        lines = list(self.known(file, scenarios, asked.players).values())
        print(report(lines, asked.out) if lines else f"{self.name}: no answer of the code as it is in {file}")
        for line in failures:
            print(f"{self.name}: {line['player']} failed at {line['key']}:\n{line['failure']}")
        return 1 if failures else 0

    def _told(self, scenarios: Sequence[S], asked: argparse.Namespace, file: Path) -> list[Line]:
        """Plays, and prints each answer as it comes; returns the failures."""
        began, failures = time.perf_counter(), []
        total = len(scenarios) * len(asked.players)
        done = len(self.known(file, scenarios, asked.players))
        print(
            f"{self.name}: {len(scenarios)} scenarios (simulated), {done} of {total} answers are in {file}",
            flush=True,
        )
        for lines in self.played(scenarios, asked.players, file, asked.processes, asked.most_effects):
            done += len(lines)
            failures += [line for line in lines if "failure" in line]
            said = " | ".join([str(lines[0]["key"]), *map(_said, lines)])
            print(f"  {done}/{total} after {time.perf_counter() - began:.0f} s: {said}", flush=True)
        return failures


def lines_of(file: Path) -> Iterator[Line]:
    """The lines that ``append`` wrote, if any; one that was cut off, by a kill, is passed over."""
    for text in file.read_text(encoding="utf-8").splitlines() if file.exists() else ():
        with suppress(json.JSONDecodeError):
            yield json.loads(text)


def append(file: Path, lines: Iterable[Line]) -> None:
    """Append ``lines`` as JSON; a last line that was cut off, by a kill, stays a line of its own."""
    cut_off = file.exists() and not file.read_bytes().endswith(b"\n")
    with file.open("a", encoding="utf-8") as out:
        out.write("\n" * cut_off + "".join(json.dumps(line, default=float) + "\n" for line in lines))


def alone(answered: Callable[[S, str, int], Mapping[str, Any] | None]) -> Callable[[S], Answered]:
    """A league's ``begun`` where its players share nothing: ``answered(scenario, player, most_effects)``."""
    return partial(partial, answered)


def beside_oracle(lines: Iterable[Line]) -> list[tuple[Line, Any]]:
    """The lines of all other players whose scenario the oracle has seen, each with the oracle's answer."""
    lines = [line for line in lines if "failure" not in line]
    told = {line["key"]: line["answer"] for line in lines if line["player"] == ORACLE}
    return [(line, told[line["key"]]) for line in lines if line["player"] != ORACLE and line["key"] in told]


def _answers(given: tuple[League[S], S, Sequence[str], int], watcher: Watcher) -> list[dict[str, Any]]:
    league, *rest = given
    return league.answer(*rest)


def _said(line: Line) -> str:
    """A line in a few words."""
    if "failure" in line:
        return f"{line['player']} FAILED"
    answer = line["answer"]
    if answer is None:
        return "nothing hidden"
    if line["player"] == ORACLE:
        return f"oracle p = {answer['p_value']:.1g}, {answer['gain']:.0%}"
    named = ", ".join(answer["named"]) or "nothing"
    verdict = answer["notes"].get("verdict", line["player"])
    return f"{verdict}: {named} ({answer['seconds']:.0f} s)"


def parser(
    prog: str,
    about: str | None,
    players: Sequence[str],
    out: Path,
    limit: str = "at most so many, evenly spread over the categories",
) -> argparse.ArgumentParser:
    """The words that every league's command takes; a league adds its own."""
    made = argparse.ArgumentParser(prog=prog, description=about)
    made.add_argument("--match", default="", help="scenarios whose key contains this")
    made.add_argument("--limit", type=int, help=limit)
    made.add_argument("--players", nargs="+", choices=players, default=list(players))
    made.add_argument("--processes", type=int, default=2, help="side by side (default: 2)")
    made.add_argument("--most-effects", type=int, default=2, help="that our trace may accept (default: 2)")
    made.add_argument("--out", type=Path, default=out)
    made.add_argument("--report", action="store_true", help="write the page from what is there, play nothing")
    made.add_argument("--list", action="store_true", help="list the scenarios and stop")
    return made


def evenly(scenarios: Iterable[S], categories: Iterable[str], limit: int | None, match: str = "") -> list[S]:
    """Of the ``scenarios`` whose key contains ``match`` at most ``limit`` in all: the first of each of
    ``categories`` in turn."""
    found = [s for s in scenarios if match in s.key]
    if limit is None or limit >= len(found):
        return found
    parts = [[s for s in found if s.category == category] for category in categories]
    kept: list[S] = []
    while len(kept) < limit:
        kept += [part.pop(0) for part in parts if part]
    return kept[:limit]
