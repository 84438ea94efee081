"""``python -m benchmarks.league``: play the league, or go on with it, and write its page."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.league.play import PLAYERS, Line, chosen, known, played
from benchmarks.league.report import write_report
from benchmarks.league.scenario import CATEGORIES
from benchmarks.league.scenarios import all_scenarios


def main(arguments: Sequence[str] | None = None) -> int:
    """Play what is missing, print what came out; 1 where a player failed."""
    asked = _parser().parse_args(arguments)
    scenarios = chosen(all_scenarios(), asked.only, asked.match, asked.limit)
    if not scenarios:
        print(f"league: no scenario matches {asked.match!r}; see --list")
        return 2
    if asked.list:
        print("\n".join(f"{s.category:16} {s.key}" for s in scenarios))
        return 0
    file = asked.out / "results.jsonl"
    failures = [] if asked.report else _play(asked, scenarios, file)
    lines = list(known(file, scenarios, asked.players).values())
    if lines:
        print(write_report(lines, asked.out))
    for line in failures:
        print(f"league: {line['player']} failed at {line['key']}:\n{line['failure']}")
    return 1 if failures else 0


def _play(asked: argparse.Namespace, scenarios, file: Path) -> list[Line]:
    began, failures = time.perf_counter(), []
    total = len(scenarios) * len(asked.players)
    done = len(known(file, scenarios, asked.players))
    print(
        f"league: {len(scenarios)} scenarios (simulated), {done} of {total} answers are in {file}", flush=True
    )
    for lines in played(scenarios, asked.players, file, asked.processes, asked.most_effects):
        done += len(lines)
        failures += [line for line in lines if "failure" in line]
        print(f"  {done}/{total} after {time.perf_counter() - began:.0f} s: {_said(lines)}", flush=True)
    return failures


def _said(lines: Sequence[Line]) -> str:
    parts = []
    for line in lines:
        if "failure" in line:
            parts.append(f"{line['player']} FAILED")
        elif line["player"] == "oracle":
            found = line["answer"]
            parts.append("nothing hidden" if found is None else f"oracle p = {found['p_value']:.1g}")
        else:
            named = ", ".join(line["answer"]["named"]) or "nothing"
            parts.append(f"{line['player']}: {named} ({line['answer']['seconds']:.0f} s)")
    return f"{lines[0]['key']} | " + " | ".join(parts)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.league", description=__doc__)
    parser.add_argument("--only", nargs="+", choices=CATEGORIES, default=[], help="categories (default: all)")
    parser.add_argument("--match", default="", help="scenarios whose key contains this")
    parser.add_argument("--limit", type=int, help="at most so many of each category, evenly spread")
    parser.add_argument("--players", nargs="+", choices=PLAYERS, default=list(PLAYERS))
    parser.add_argument("--processes", type=int, default=2, help="side by side (default: 2)")
    parser.add_argument("--most-effects", type=int, default=2, help="that our trace may accept (default: 2)")
    parser.add_argument("--out", type=Path, default=Path("outputs/league"))
    parser.add_argument(
        "--report", action="store_true", help="write the page from what is there, play nothing"
    )
    parser.add_argument("--list", action="store_true", help="list the scenarios and stop")
    return parser


if __name__ == "__main__":
    raise SystemExit(main())
