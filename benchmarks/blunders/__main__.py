"""``python -m benchmarks.blunders``: plant blunders, fit, and count what is told. Simulated."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from benchmarks.blunders.draw import DEVELOPED, JUDGED, KINDS, SOUND
from benchmarks.blunders.play import Outcome, played
from benchmarks.blunders.report import table, write

BLUNDERS, SOUNDS = 200, 200


def main(arguments: Sequence[str] | None = None) -> int:
    """Play the draws and write the counts to ``outputs/studies``."""
    words = argparse.ArgumentParser(
        prog="python -m benchmarks.blunders", description=(__doc__ or "").splitlines()[0]
    )
    words.add_argument("--share", type=float, default=1.0, help="of the 200 and 200 draws (default: all)")
    words.add_argument(
        "--develop", action="store_true", help="the draws that rules are developed on, not the judges"
    )
    asked = words.parse_args(arguments)
    seed = DEVELOPED if asked.develop else JUDGED
    each = round(asked.share * BLUNDERS / len(KINDS))
    draws = [(kind, k) for k in range(each) for kind in KINDS]
    draws += [(SOUND, k) for k in range(round(asked.share * SOUNDS))]
    rows: list[Outcome] = []
    for kind, number in draws:
        rows.append(played(kind, number, seed))
        last = rows[-1]
        what = f"{kind} {number} (simulated) {last.machine}, {last.planted or 'nothing'}"
        print(f"{what}: {last.verdict} {last.findings}", flush=True)
    print(table(rows))
    print(f"written: {write(rows, seed)}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
