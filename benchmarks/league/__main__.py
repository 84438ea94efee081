"""``python -m benchmarks.league``: play the league, or go on with it, and write its page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.answers import parser
from benchmarks.league.play import LEAGUE, PLAYERS, chosen
from benchmarks.league.report import write_report
from benchmarks.league.scenario import CATEGORIES
from benchmarks.league.scenarios import all_scenarios


def main(arguments: Sequence[str] | None = None) -> int:
    """Play what is missing, print what came out; 1 where a player failed."""
    words = parser(
        "python -m benchmarks.league",
        __doc__,
        PLAYERS,
        Path("outputs/league"),
        limit="at most so many of each category, evenly spread",
    )
    words.add_argument("--only", nargs="+", choices=CATEGORIES, default=[], help="categories (default: all)")
    asked = words.parse_args(arguments)
    scenarios = chosen(all_scenarios(), asked.only, asked.match, asked.limit)
    return LEAGUE.conduct(scenarios, asked, write_report)


if __name__ == "__main__":
    raise SystemExit(main())
