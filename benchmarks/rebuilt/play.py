"""The rebuilt rows before the oracle and our trace."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

from benchmarks.answers import ORACLE, League, alone, version_of
from benchmarks.drawn import oracle, ours
from benchmarks.rebuilt import machines
from benchmarks.rebuilt.draw import Draw

PLAYERS = (ORACLE, ours.NAME)


def version(player: str) -> str:
    """SHA-256 of the code that decides what ``player`` answers, its scenarios' records included."""
    return version_of(machines, oracle if player == ORACLE else ours)


def consult(draw: Draw) -> dict[str, Any]:
    """What the records of ``draw`` can show of what is missing, as ``benchmarks.drawn.oracle`` has it."""
    began = time.process_time()
    case = machines.declared(draw)
    empty = oracle.declared_score(case, machines.records_of(draw, quiet=True, empty=True))
    hides = draw.category != "nothing"
    worked = oracle.declared_score(case, machines.records_of(draw, quiet=True)) if hides else empty
    return {**oracle.shown(empty, worked, draw.noise), "seconds": time.process_time() - began}


def _answered(draw: Draw, player: str, most_effects: int) -> dict[str, Any]:
    if player == ORACLE:
        return consult(draw)
    records = machines.records_of(draw)
    answer, found = ours.traced(machines.declared(draw), records, draw.noise, most_effects)
    return replace(answer, notes={**answer.notes, "times": found.times}).described()


LEAGUE = League("rebuilt rows", PLAYERS, version, alone(_answered))
