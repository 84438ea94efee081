"""``python -m benchmarks.torture``: begin or go on, and write docs/reliability.md."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.answers import evenly
from benchmarks.torture import disks, endurance, kills, stores
from benchmarks.torture.bench import Line, Trial, conducted, known
from benchmarks.torture.report import write_report

PARTS = {part.PART: part.trials for part in (kills, disks, stores, endurance)}


def main(arguments: Sequence[str] | None = None) -> int:
    """Carry out what is missing, print what came of it; 1 where something broke."""
    asked = _parser().parse_args(arguments)
    trials = [trial for part in asked.only for trial in _of(part, asked)]
    if asked.list:
        print("\n".join(trial.key for trial in trials))
        return 0
    file = asked.out / "results.jsonl"
    if not asked.report:
        _told(trials, file, asked.any_code)
    lines = list(known(file, trials, asked.any_code).values())
    print(write_report(lines, asked.page, asked.seed))
    return int(any(line["faults"] for line in lines))


def _of(part: str, asked: argparse.Namespace) -> list[Trial]:
    found = [trial for trial in PARTS[part](asked.seed) if asked.match in trial.key]
    return evenly(found, dict.fromkeys(trial.category for trial in found), asked.limit)


def _told(trials: Sequence[Trial], file: Path, any_code: bool) -> None:
    began, there = time.monotonic(), known(file, trials, any_code)
    done = sum(not line["faults"] for line in there.values())
    print(f"torture: {len(trials)} trials, {done} of them are in {file}", flush=True)
    for line in conducted(trials, file, any_code):
        done += 1
        print(f"  {done}/{len(trials)} after {time.monotonic() - began:.0f} s: {_said(line)}", flush=True)


def _said(line: Line) -> str:
    faults = "".join(f"\n      {fault['kind'].upper()}: {fault['what']}" for fault in line["faults"])
    return f"{line['key']}: {line['skipped'] or line['said']}{faults}"


def _parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(prog="python -m benchmarks.torture", description=__doc__)
    made.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS), help="parts (default: all)")
    made.add_argument("--match", default="", help="trials whose key contains this")
    made.add_argument("--limit", type=int, help="at most so many of each part, evenly over its categories")
    made.add_argument("--seed", type=int, default=20, help="of all that is drawn (default: 20)")
    made.add_argument("--out", type=Path, default=Path("outputs/torture"))
    made.add_argument("--page", type=Path, default=Path("docs/reliability.md"))
    made.add_argument(
        "--any-code", action="store_true", help="count trials of other versions of the code too"
    )
    made.add_argument(
        "--report", action="store_true", help="write the page from what is there, torture nothing"
    )
    made.add_argument("--list", action="store_true", help="list the trials and stop")
    return made


if __name__ == "__main__":
    raise SystemExit(main())
