"""The drawn league before the oracle and our trace."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from functools import cache, partial
from typing import Any

from benchmarks.answers import ORACLE, League, evenly
from benchmarks.drawn import amount, oracle, ours
from benchmarks.drawn.draw import CATEGORIES, Draw
from pipelines.shared.source_code import code_of

PLAYERS = (ORACLE, ours.NAME)


@cache
def version(player: str) -> str:
    """SHA-256 of the code that decides what ``player`` answers, its scenarios' records included."""
    decides = oracle if player == ORACLE else ours
    code = [code_of(module.__name__) for module in (amount, decides)]
    return hashlib.sha256(json.dumps(code).encode()).hexdigest()[:16]


def chosen(draws: Iterable[Draw], match: str = "", limit: int | None = None) -> list[Draw]:
    """Those whose key contains ``match``; at most ``limit``, evenly spread over the categories."""
    return evenly([draw for draw in draws if match in draw.key], CATEGORIES, limit)


def _begun(draw: Draw):
    return partial(_answered, draw)


def _answered(draw: Draw, player: str, most_effects: int) -> dict[str, Any]:
    if player == ORACLE:
        found = oracle.consult(draw)
        return {**vars(found), "detectable": found.detectable}
    return ours.play(draw, amount.records_of(draw), most_effects).described()


LEAGUE = League("drawn league", PLAYERS, version, Draw.described, _begun)
line, known = LEAGUE.line, LEAGUE.known
