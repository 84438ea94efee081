"""``python -m benchmarks.rebuilt``: play the rebuilt rows, or go on with them, and write their page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.answers import evenly, parser
from benchmarks.rebuilt.draw import CATEGORIES, all_draws
from benchmarks.rebuilt.play import LEAGUE, PLAYERS
from benchmarks.rebuilt.report import write_report


def main(arguments: Sequence[str] | None = None) -> int:
    """Play what is missing, print what came out; 1 where a player failed."""
    words = parser("python -m benchmarks.rebuilt", __doc__, PLAYERS, Path("outputs/study-rebuilt"))
    words.add_argument("--series", type=int, default=0, help="of draws: 0, 1, 2, ... (default: 0)")
    asked = words.parse_args(arguments)
    draws = evenly(all_draws(asked.series), CATEGORIES, asked.limit, asked.match)
    return LEAGUE.conduct(draws, asked, write_report)


if __name__ == "__main__":
    raise SystemExit(main())
