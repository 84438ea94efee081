"""The players: the oracle, and our trace with ``trace.revise=true``.

``ours`` composes no law. ``whole`` is the trace as an engineer gets it, with laws. Both try the whole library
and pairs, and accept what the rules allow. What ends at zero is said of the last model, refitted to the whole
record, as ``hybridid.trace.words.summary`` says it.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

from benchmarks.answers import ORACLE, League, alone, version_of
from benchmarks.declarations import machines
from benchmarks.declarations.draw import FRICTION, Draw
from benchmarks.drawn import oracle
from benchmarks.drawn.ours import class_of
from hybridid.effects.effect import Effect
from hybridid.effects.library import EFFECTS
from hybridid.estimators import Estimate, FitSettings
from hybridid.simulation.chosen import as_integrator
from hybridid.trace import run
from hybridid.trace.context import Context
from hybridid.trace.results.before_after import Validation, before_and_after
from hybridid.trace.results.idle import idle_terms
from hybridid.trace.search.revision import Replacement
from hybridid.trace.verdict import Conclusion, conclude

NAME, WHOLE = "ours", "whole"
PLAYERS = (ORACLE, NAME, WHOLE)


def version(player: str) -> str:
    """SHA-256 of the code that decides what ``player`` answers, its scenarios' records included."""
    return version_of(machines, oracle if player == ORACLE else run)


def consult(draw: Draw) -> dict[str, Any] | None:
    """What the records of ``draw`` can show against its declaration, as ``benchmarks.drawn.oracle`` has it:
    the declared model against the true one, both refitted to noise-free records.

    None where nothing in the records speaks against the declaration: it is sound, or its spring is zero.
    """
    if draw.category != FRICTION:
        return None
    began = time.process_time()
    records = machines.records_of(draw, quiet=True)
    true, declared = (
        oracle.declared_score(case, records) for case in (machines.true_case(draw), machines.declared(draw))
    )
    shown = oracle.shown(true, declared, draw.noise)
    return {**shown, "seconds": time.process_time() - began}


def _answered(draw: Draw, player: str, most_effects: int) -> dict[str, Any] | None:
    return consult(draw) if player == ORACLE else traced(draw, laws=player == WHOLE)


def traced(
    draw: Draw, laws: bool, effects: Sequence[Effect] = EFFECTS, ports: tuple[str, ...] | None = None
) -> dict[str, Any]:
    """What the trace over ``effects`` at ``ports`` (None: all) says of ``draw``."""
    began, case = time.process_time(), machines.declared(draw)
    split = oracle.split_of(case, machines.records_of(draw))
    context = Context(split, tuple(effects), ports=ports, laws=laws, revise=True)
    found = conclude(case.model(), context)
    last = _refitted(found, context)
    return {
        "named": [one.name for one in found.accepted],
        "classes": list(map(class_of, found.accepted)),
        "replaced": list(map(_replaced, found.replacements)),
        "idle": list(idle_terms(found.search.first.model, last)),
        "values": {p.name: [p.value, p.std] for p in last.parameters},
        "before": found.search.first.score.loss,
        "after": found.search.final.score.loss,
        "seconds": time.process_time() - began,
        "notes": {"verdict": found.verdict, "stopped": found.search.stopped, "times": found.times},
    }


def _refitted(found: Conclusion, context: Context) -> Estimate:
    """The last model, refitted to the whole record that was fitted, as ``hybridid.trace.run`` does it."""
    integrator = as_integrator(found.search.first.numerics.integrator)
    settings = FitSettings(horizon=context.split.horizon, integrator=integrator)
    (fitted, _), seconds = context.split.records, context.split.horizon * context.split.records[0].dt
    return before_and_after(found, Validation((fitted,), (), settings, seconds), context)[-1].estimate


def _replaced(one: Replacement) -> dict[str, Any]:
    return {
        "left_out": one.left_out,
        "classes": list(map(class_of, one.accepted)),
        "kind": one.kind,
        "gain": one.gain,
        "p_value": one.p_value,
        "fewer": one.fewer,
    }


LEAGUE = League("study of declarations", PLAYERS, version, alone(_answered))
