"""The players: the oracle of the drawn league, and our trace without the effect that is hidden."""

from __future__ import annotations

import time
from typing import Any

from benchmarks.answers import ORACLE, League, alone, version_of
from benchmarks.drawn import amount, oracle
from benchmarks.drawn.draw import Draw
from benchmarks.drawn.machines import case_of
from benchmarks.drawn.oracle import split_of
from benchmarks.drawn.ours import class_of
from hybridid.effects.composed import FORMS, is_composed
from hybridid.effects.library import EFFECTS
from hybridid.trace import verdict
from hybridid.trace.context import Context
from hybridid.trace.rules import Rules

NAME = "ours"
PLAYERS = (ORACLE, NAME)


def version(player: str) -> str:
    """SHA-256 of the code that decides what ``player`` answers, its scenarios' records included."""
    return version_of(amount, oracle if player == ORACLE else verdict)


def answered(draw: Draw, player: str, most_effects: int) -> dict[str, Any]:
    """What ``player`` says of a scenario."""
    if player == ORACLE:
        return vars(oracle.consult(draw))
    return _ours(draw, most_effects)


def _ours(draw: Draw, most_effects: int) -> dict[str, Any]:
    began, case = time.process_time(), case_of(draw)
    records = amount.records_of(draw)
    hidden = draw.wanted.what if draw.wanted else ""
    effects = tuple(effect for effect in EFFECTS if effect.id != hidden)
    found = verdict.conclude(
        case.model(), Context(split_of(case, records), effects, Rules(most_effects=most_effects))
    )
    laws = [one for one in found.accepted if is_composed(one.trial.candidate.effect)]
    names = [one for one in found.accepted if one not in laws]
    return {
        "named": [one.name for one in found.accepted],
        "names": [class_of(one) for one in names],
        "laws": [class_of(one) for one in laws],
        "forms": sorted({FORMS.get(law.rpartition(".")[2], "") for one in laws for law in class_of(one)}),
        "values": laws[0].trial.own("values") if laws else {},
        "before": found.search.first.score.loss,
        "after": found.search.final.score.loss,
        "seconds": time.process_time() - began,
        "notes": {"verdict": found.verdict, "stopped": found.search.stopped, "remains": list(found.remains)},
    }


LEAGUE = League("laws beyond the library", PLAYERS, version, alone(answered))
