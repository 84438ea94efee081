"""``python -m benchmarks.speed``: time the package beside other ways to its results, and write a page."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from benchmarks.speed.commands import commands
from benchmarks.speed.fits import beside, growing
from benchmarks.speed.networks import networks
from benchmarks.speed.report import write_report
from benchmarks.speed.row import Row
from benchmarks.speed.simulations import simulations
from benchmarks.speed.traces import traces

Part = Callable[[int, Callable[[str], None], bool], Iterator[Row]]
PARTS: dict[str, Part] = {
    "fits": beside,
    "growing": growing,
    "simulations": simulations,
    "networks": networks,
    "commands": commands,
    "traces": traces,
}


def main(arguments: Sequence[str] | None = None, say: Callable[[str], None] = print) -> list[Row]:
    """Time the parts that were asked for and write ``OUT``."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS), help="parts (default: all)")
    parser.add_argument("--repeats", type=int, default=5, help="of what is fast (default: 5)")
    parser.add_argument("--quick", action="store_true", help="only what takes seconds")
    parser.add_argument("--out", type=Path, default=Path("outputs/benchmark"))
    asked = parser.parse_args(arguments)
    rows: list[Row] = []
    said = ""
    for name in asked.only:  # a page after each part: the last ones take long
        rows += PARTS[name](asked.repeats, say, asked.quick)
        said = write_report(rows, asked.out)
    say(said)
    return rows


if __name__ == "__main__":
    main()
