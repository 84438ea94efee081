"""The drawn league before the oracle and our trace."""

from __future__ import annotations

from typing import Any

from benchmarks.answers import ORACLE, League, alone, version_of
from benchmarks.drawn import amount, oracle, ours
from benchmarks.drawn.draw import Draw
from hybridid.trace.rules import Rules

WHOLE = "whole"
"""Our trace as an engineer gets it: laws are composed, and as many effects accepted as the rules allow."""
PLAYERS = (ORACLE, ours.NAME, WHOLE)


def version(player: str) -> str:
    """SHA-256 of the code that decides what ``player`` answers, its scenarios' records included."""
    return version_of(amount, oracle if player == ORACLE else ours)


def _answered(draw: Draw, player: str, most_effects: int) -> dict[str, Any]:
    if player == ORACLE:
        return vars(oracle.consult(draw))
    records = amount.records_of(draw)
    if player == WHOLE:
        return ours.play(draw, records, Rules().most_effects, laws=True).described()
    return ours.play(draw, records, most_effects).described()


LEAGUE = League("drawn league", PLAYERS, version, alone(_answered))
line, known = LEAGUE.line, LEAGUE.known
