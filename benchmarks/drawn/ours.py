"""Our player in the drawn league: a trace over the whole library with its default rules."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

from benchmarks.drawn.draw import Draw
from benchmarks.drawn.machines import case_of
from benchmarks.drawn.oracle import split_of
from benchmarks.league.answer import Answer
from benchmarks.league.machines import Declared
from benchmarks.league.ours import NAME, _step_notes
from hybridid.effects.composed import is_composed
from hybridid.effects.library import EFFECTS
from hybridid.records.record import Record
from hybridid.trace.context import Context
from hybridid.trace.rules import Rules
from hybridid.trace.search.steps import Accepted
from hybridid.trace.verdict import Conclusion, conclude


def play(
    draw: Draw,
    records: tuple[Record, Record],
    most_effects: int = 2,
    ids: Sequence[str] | None = None,
    laws: bool = False,
) -> Answer:
    """A trace over the library (or its effects ``ids``) that may accept ``most_effects``; with ``laws`` as an
    engineer gets it."""
    return traced(case_of(draw), records, draw.noise, most_effects, ids, laws)[0]


def traced(
    case: Declared,
    records: tuple[Record, Record],
    noise: float,
    most_effects: int,
    ids: Sequence[str] | None = None,
    laws: bool = False,
) -> tuple[Answer, Conclusion]:
    """A trace of ``case`` and the answer that it comes to.

    ``notes`` hold the verdict, the class of every accepted effect and, of each output, the last model's
    held-out RMSE over ``noise``, the sensor's. With ``laws`` they are composed where no name holds; they are
    no names, and stand apart.
    """
    began = time.process_time()
    effects = tuple(effect for effect in EFFECTS if ids is None or effect.id in ids)
    context = Context(split_of(case, records), effects, Rules(most_effects=most_effects), laws=laws)
    found = conclude(case.model(), context)
    named = [one for one in found.accepted if not is_composed(one.trial.candidate.effect)]
    classes = list(map(class_of, named))
    first = named[0] if named else None
    answer = Answer(
        player=NAME,
        named=tuple(one.name for one in named),
        alike=tuple(classes[0]) if classes else (),
        values=first.trial.own("values") if first else {},
        before=found.search.first.score.loss,
        after=found.search.final.score.loss,
        remains=bool(found.remains),
        seconds=time.process_time() - began,
        notes=_notes(noise, found, classes),
    )
    return answer, found


def class_of(one: Accepted) -> list[str]:
    """An accepted effect, and those that the records cannot tell from it."""
    return list(dict.fromkeys([one.name, *(trial.candidate.name for trial in one.alike)]))


def _notes(noise: float, found: Conclusion, classes: list[list[str]]) -> dict[str, Any]:
    return {
        "verdict": found.verdict,
        "classes": classes,
        "laws": [one.name for one in found.accepted if is_composed(one.trial.candidate.effect)],
        "over_noise": (found.search.final.score.rmse / noise).tolist(),
        "remains": list(found.remains),
        "stopped": found.search.stopped,
        "steps": [_step_notes(step.trials) for step in found.search.steps],
    }
