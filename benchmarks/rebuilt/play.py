"""The rebuilt rows before the oracle and our trace."""

from __future__ import annotations

import hashlib
import json
import time
from dataclasses import replace
from functools import cache, partial
from typing import Any

from benchmarks.answers import ORACLE, League
from benchmarks.drawn import oracle, ours
from benchmarks.league.ours import DETECTABLE
from benchmarks.rebuilt import machines
from benchmarks.rebuilt.draw import Draw
from pipelines.shared.source_code import code_of

PLAYERS = (ORACLE, ours.NAME)


@cache
def version(player: str) -> str:
    """SHA-256 of the code that decides what ``player`` answers, its scenarios' records included."""
    decides = oracle if player == ORACLE else ours
    code = [code_of(module.__name__) for module in (machines, decides)]
    return hashlib.sha256(json.dumps(code).encode()).hexdigest()[:16]


def consult(draw: Draw) -> dict[str, Any]:
    """What the records of ``draw`` can show of what is missing, as ``benchmarks.drawn.oracle`` has it."""
    began = time.process_time()
    case = machines.declared(draw)
    empty = oracle.declared_score(case, machines.records_of(draw, quiet=True, empty=True))
    hides = draw.category != "nothing"
    worked = oracle.declared_score(case, machines.records_of(draw, quiet=True)) if hides else empty
    shown = oracle.shown(empty, worked, draw.noise)
    detectable = shown["p_value"] < DETECTABLE
    return {**shown, "detectable": detectable, "seconds": time.process_time() - began}


def _answered(draw: Draw, player: str, most_effects: int) -> dict[str, Any]:
    if player == ORACLE:
        return consult(draw)
    records = machines.records_of(draw)
    answer, found = ours.traced(machines.declared(draw), records, draw.noise, most_effects)
    return replace(answer, notes={**answer.notes, "times": found.times}).described()


def _begun(draw: Draw):
    return partial(_answered, draw)


LEAGUE = League("rebuilt rows", PLAYERS, version, Draw.described, _begun)
