"""``python -m benchmarks.drawn``: play the drawn league, or go on with it, and write its page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.answers import ORACLE, evenly, parser
from benchmarks.drawn.draw import CATEGORIES, all_draws
from benchmarks.drawn.ours import NAME
from benchmarks.drawn.play import LEAGUE, PLAYERS
from benchmarks.drawn.report import write_report


def main(arguments: Sequence[str] | None = None) -> int:
    """Play what is missing, print what came out; 1 where a player failed."""
    words = parser("python -m benchmarks.drawn", __doc__, PLAYERS, Path("outputs/league-drawn"))
    words.add_argument("--series", type=int, default=0, help="of draws: 0, 1, 2, ... (default: 0)")
    words.set_defaults(players=[ORACLE, NAME])
    asked = words.parse_args(arguments)
    draws = evenly(all_draws(asked.series), CATEGORIES, asked.limit, asked.match)
    return LEAGUE.conduct(draws, asked, write_report)


if __name__ == "__main__":
    raise SystemExit(main())
