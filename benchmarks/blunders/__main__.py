"""``python -m benchmarks.blunders``: plant blunders, fit, and count what is told. Simulated."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import zip_longest

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
    rows: list[Outcome] = []
    for kind, number in _draws(asked.share):
        rows.append(played(kind, number, seed))
        last = rows[-1]
        what = f"{kind} {number} (simulated) {last.machine}, {last.planted or 'nothing'}"
        print(f"{what}: {last.verdict} {last.findings}", flush=True)
    print(table(rows))
    print(f"written: {write(rows, seed)}")
    return 0


def _draws(share: float) -> list[tuple[str, int]]:
    """Kind and number of each draw; blunders and sound records in turn, so that a study that was cut off has
    seen both."""
    each = round(share * BLUNDERS / len(KINDS))
    blunders = [(kind, k) for k in range(each) for kind in KINDS]
    sound = [(SOUND, k) for k in range(round(share * SOUNDS))]
    return [draw for pair in zip_longest(blunders, sound) for draw in pair if draw]


if __name__ == "__main__":
    raise SystemExit(main())
