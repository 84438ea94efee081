"""``python -m benchmarks.strangers``: from a recording to a traced report, machine by machine. Simulated."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from pathlib import Path

from benchmarks.strangers.play import Outcome, machines, played
from benchmarks.strangers.report import row, table, write


def main(arguments: Sequence[str] | None = None) -> int:
    """Play the machines and write the table to ``outputs/studies``."""
    words = argparse.ArgumentParser(
        prog="python -m benchmarks.strangers", description=(__doc__ or "").splitlines()[0]
    )
    words.add_argument("--only", nargs="+", default=None, metavar="MACHINE", help="names of machines")
    words.add_argument("--keep", type=Path, default=None, help="folder that keeps recordings and reports")
    asked = words.parse_args(arguments)
    chosen = [one for one in machines() if asked.only is None or one.name in asked.only]
    rows: list[Outcome] = []
    for machine in chosen:
        with tempfile.TemporaryDirectory(prefix="strangers-") as scratch:
            folder = asked.keep or Path(scratch)
            folder.mkdir(parents=True, exist_ok=True)
            rows.append(played(machine, folder))
        print(row(rows[-1]), flush=True)
    print(table(rows))
    if asked.only is None:
        print(f"written: {write(rows)}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
