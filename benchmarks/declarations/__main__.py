"""``python -m benchmarks.declarations``: is declared physics that is wrong told? (simulated)"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.answers import evenly, parser
from benchmarks.declarations.draw import CATEGORIES, all_draws
from benchmarks.declarations.play import LEAGUE, NAME, ORACLE, PLAYERS
from benchmarks.declarations.report import write_report


def main(arguments: Sequence[str] | None = None) -> int:
    """Play what is missing, print what came out; 1 where a player failed."""
    words = parser("python -m benchmarks.declarations", __doc__, PLAYERS, Path("outputs/declarations"))
    words.set_defaults(players=[ORACLE, NAME])
    asked = words.parse_args(arguments)
    draws = evenly(all_draws(), CATEGORIES, asked.limit, asked.match)
    return LEAGUE.conduct(draws, asked, write_report)


if __name__ == "__main__":
    raise SystemExit(main())
