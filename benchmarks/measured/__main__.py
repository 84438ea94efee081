"""``python -m benchmarks.measured``: trace every measured record, also with each declared effect left out."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.measured.entry import HERE, entries, every
from benchmarks.measured.play import outcomes
from benchmarks.measured.report import line, write_report


def main(arguments: Sequence[str] | None = None) -> int:
    """Trace what is missing and write the page; 1 where a trace failed."""
    asked = _parser().parse_args(arguments)
    chosen = [one for one in every(entries(asked.entries)) if asked.match in one.key]
    began, ended = time.monotonic(), {}
    for one in outcomes(chosen, asked.out, asked.processes):
        ended[one.asked.key] = one
        print(line(one), flush=True)
    found = [ended[one.key] for one in chosen]
    print(write_report(found, asked.out, time.monotonic() - began).splitlines()[-1])
    return int(any(one.failure for one in found))


def _parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(prog="python -m benchmarks.measured", description=__doc__)
    made.add_argument("--match", default="", help="only traces whose name contains this, as emps/without")
    made.add_argument("--processes", type=int, default=2, help="traces side by side (default: 2)")
    made.add_argument("--out", type=Path, default=Path("outputs/measured"))
    made.add_argument("--entries", type=Path, default=HERE, help="a folder with a folder for each record")
    return made


if __name__ == "__main__":
    raise SystemExit(main())
