"""``python -m benchmarks.laws``: where the library lacks the effect, is its law proposed? (simulated)"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.answers import evenly, parser
from benchmarks.laws.play import LEAGUE, PLAYERS
from benchmarks.laws.report import write_report
from benchmarks.laws.scenarios import CATEGORIES, scenarios


def main(arguments: Sequence[str] | None = None) -> int:
    """Play what is missing, print what came out; 1 where a player failed."""
    words = parser("python -m benchmarks.laws", __doc__, PLAYERS, Path("outputs/laws"))
    words.add_argument("--series", type=int, default=0, help="of draws: 0, 1, 2, ... (default: 0)")
    asked = words.parse_args(arguments)
    draws = evenly(scenarios(asked.series), CATEGORIES, asked.limit, asked.match)
    return LEAGUE.conduct(draws, asked, write_report)


if __name__ == "__main__":
    raise SystemExit(main())
