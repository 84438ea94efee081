"""``python -m benchmarks.drawn``: play the drawn league, or go on with it, and write its page."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.drawn.draw import Draw, all_draws
from benchmarks.drawn.play import PLAYERS, chosen, known, played
from benchmarks.drawn.report import write_report
from benchmarks.drawn.scoring import ORACLE, Line


def main(arguments: Sequence[str] | None = None) -> int:
    """Play what is missing, print what came out; 1 where a player failed."""
    asked = _parser().parse_args(arguments)
    draws = chosen(all_draws(), asked.match, asked.limit)
    if not draws:
        print(f"drawn league: no scenario matches {asked.match!r}; see --list")
        return 2
    if asked.list:
        print("\n".join(f"{draw.category:8} {draw.key}" for draw in draws))
        return 0
    file = asked.out / "results.jsonl"
    failures = [] if asked.report else _play(asked, draws, file)
    lines = list(known(file, draws, asked.players).values())
    if lines:
        print(write_report(lines, asked.out))
    for line in failures:
        print(f"drawn league: {line['player']} failed at {line['key']}:\n{line['failure']}")
    return 1 if failures else 0


def _play(asked: argparse.Namespace, draws: Sequence[Draw], file: Path) -> list[Line]:
    began, failures = time.perf_counter(), []
    total, done = len(draws) * len(asked.players), len(known(file, draws, asked.players))
    print(
        f"drawn league: {len(draws)} scenarios (simulated), {done} of {total} answers are in {file}",
        flush=True,
    )
    for lines in played(draws, asked.players, file, asked.processes, asked.most_effects):
        done += len(lines)
        failures += [line for line in lines if "failure" in line]
        print(f"  {done}/{total} after {time.perf_counter() - began:.0f} s: {_said(lines)}", flush=True)
    return failures


def _said(lines: Sequence[Line]) -> str:
    parts = []
    for line in lines:
        answer = line.get("answer")
        if answer is None:
            parts.append(f"{line['player']} FAILED")
        elif line["player"] == ORACLE:
            parts.append(f"oracle p = {answer['p_value']:.1g}, {answer['gain']:.0%}")
        else:
            named = ", ".join(answer["named"]) or "nothing"
            parts.append(f"{answer['notes']['verdict']}: {named} ({answer['seconds']:.0f} s)")
    return f"{lines[0]['key']} | " + " | ".join(parts)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.drawn", description=__doc__)
    parser.add_argument("--match", default="", help="scenarios whose key contains this")
    parser.add_argument("--limit", type=int, help="at most so many, evenly spread over the categories")
    parser.add_argument("--players", nargs="+", choices=PLAYERS, default=list(PLAYERS))
    parser.add_argument("--processes", type=int, default=2, help="side by side (default: 2)")
    parser.add_argument("--most-effects", type=int, default=2, help="that our trace may accept (default: 2)")
    parser.add_argument("--out", type=Path, default=Path("outputs/league-drawn"))
    parser.add_argument(
        "--report", action="store_true", help="write the page from what is there, play nothing"
    )
    parser.add_argument("--list", action="store_true", help="list the scenarios and stop")
    return parser


if __name__ == "__main__":
    raise SystemExit(main())
