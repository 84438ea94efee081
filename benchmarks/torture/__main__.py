"""``python -m benchmarks.torture``: begin or go on, and write docs/reliability.md.

Several at once may share a folder if their trials differ, by --only or --match.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.answers import evenly
from benchmarks.torture import disks, endurance, inputs, kills, properties, received, secrets, stores
from benchmarks.torture.bench import Line, Part, Trial, conducted, known, undone
from benchmarks.torture.report import write_report

MODULES = (inputs, properties, received, kills, disks, stores, endurance, secrets)
PARTS: tuple[Part, ...] = tuple(module.PART for module in MODULES)
"""The parts in the order of the page."""
NAMES = [part.name for part in PARTS]


def main(arguments: Sequence[str] | None = None) -> int:
    """Carry out what is missing, write the page; 1 where something broke."""
    asked = _parser().parse_args(arguments)
    chosen = [(part, _of(part, asked)) for part in PARTS if part.name in asked.only]
    if asked.list:
        print("\n".join(trial.key for _, trials in chosen for trial in trials))
        return 0
    file = asked.out / "results.jsonl"
    for part, trials in () if asked.report else chosen:
        _told(part, trials, file, asked.any_code)
    there = {part: known(file, part.trials(asked.seed)) for part in PARTS}
    print(write_report(there, asked.page, asked.seed))
    return int(any(line["faults"] for lines in there.values() for line in lines.values()))


def _of(part: Part, asked: argparse.Namespace) -> list[Trial]:
    found = [t for t in part.trials(asked.seed) if any(words in t.key for words in asked.match)]
    return evenly(found, dict.fromkeys(trial.category for trial in found), asked.limit)


def _told(part: Part, trials: Sequence[Trial], file: Path, any_code: bool) -> None:
    began, done = time.monotonic(), len(trials) - len(undone(trials, file, any_code))
    print(f"{part.name}: {len(trials)} trials, {done} of them are in {file}", flush=True)
    for line in conducted(part.name, trials, file, any_code):
        done += 1
        print(f"  {done}/{len(trials)} after {time.monotonic() - began:.0f} s: {_said(line)}", flush=True)


def _said(line: Line) -> str:
    faults = "".join(f"\n      {fault['kind'].upper()}: {fault['what']}" for fault in line["faults"])
    return f"{line['key']}: {line['skipped'] or line['said']}{faults}"


def _parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(prog="python -m benchmarks.torture", description=__doc__)
    made.add_argument("--only", nargs="+", choices=NAMES, default=NAMES, help="parts (default: all)")
    made.add_argument("--match", nargs="+", default=[""], help="trials whose key contains one of these")
    made.add_argument("--limit", type=int, help="at most so many of each part, evenly over its categories")
    made.add_argument("--seed", type=int, default=20, help="of all that is drawn (default: 20)")
    made.add_argument("--out", type=Path, default=Path("outputs/torture"))
    made.add_argument("--page", type=Path, default=Path("docs/reliability.md"))
    made.add_argument(
        "--any-code", action="store_true", help="do not repeat sound trials of other versions of the code"
    )
    made.add_argument(
        "--report", action="store_true", help="write the page from what is there, torture nothing"
    )
    made.add_argument("--list", action="store_true", help="list the trials and stop")
    return made


if __name__ == "__main__":
    raise SystemExit(main())
