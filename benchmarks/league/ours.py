"""Our player: a trace over the whole library; and the oracle that is told what was planted."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

from benchmarks.league.answer import Answer
from benchmarks.league.machines import CASES
from benchmarks.league.planting import Hidden
from benchmarks.league.scenario import Scenario
from hybridid.effects.library import EFFECTS
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.score import Score
from hybridid.trace.horizons.split import Split, by_record
from hybridid.trace.refits.declared_starts import regressed
from hybridid.trace.refits.refit import CONTINUATION, refit
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.trials.trial import Trial
from hybridid.trace.verdict import conclude

DETECTABLE = 1e-3
NAME = "ours"


def play(
    scenario: Scenario, records: tuple[Record, Record], most_effects: int = 2, ids=None, over=None
) -> Answer:
    """A trace over the whole library (or the effects ``ids``, with learned efforts ``over`` these variables
    alone), with its default rules. The league judges
    names: no law is composed."""
    began = time.process_time()
    effects = [effect for effect in EFFECTS if ids is None or effect.id in ids]
    split = _split(scenario, records)
    model = CASES[scenario.machine].model()
    rules = Rules(most_effects=most_effects)
    found = conclude(model, Context(split, tuple(effects), rules, laws=False, variables=over))
    first = found.accepted[0] if found.accepted else None
    return Answer(
        player=NAME,
        named=tuple(one.name for one in found.accepted),
        alike=tuple(t.candidate.name for t in (first.alike if first else ())),
        values=first.trial.own("values") if first else {},
        before=found.search.first.score.loss,
        after=found.search.final.score.loss,
        remains=bool(found.remains),
        seconds=time.process_time() - began,
        notes={
            "verdict": found.verdict,
            "stopped": found.search.stopped,
            "steps": [_step_notes(step.trials) for step in found.search.steps],
        },
    )


def _step_notes(trials: tuple[Trial, ...]) -> list[dict[str, Any]]:
    """The trials that came nearest, and why each ended as it did."""
    best = sorted(trials, key=lambda t: -t.gain)[:8]
    return [
        {"name": t.candidate.name, "gain": t.gain, "p": t.p_adjusted, "status": t.status, "reason": t.reason}
        for t in best
    ]


def _split(scenario: Scenario, records: tuple[Record, Record]) -> Split:
    return by_record(records[:1], records[1:], CASES[scenario.machine].horizon)


@dataclass(frozen=True)
class Oracle:
    """The true structure against the declared, both fitted by our estimator on the same horizons.

    Held out: ``gain``; ``p_value`` as the trace has it, of the whitened likelihood ratio; ``p_errors`` that
    the logarithm of the horizons' mean square error does not fall, which one bad horizon cannot upset.
    Either detects. ``error`` of each planted value that the truth states, relative to it.
    """

    gain: float
    p_value: float
    p_errors: float
    before: float
    after: float
    error: dict[str, float]
    seconds: float

    @property
    def detectable(self) -> bool:
        return min(self.p_value, self.p_errors) < DETECTABLE and self.gain > 0


def consult(scenario: Scenario, records: tuple[Record, Record]) -> Oracle | None:
    """None where nothing is planted.

    It starts from the truth: what it cannot find is not in the records.
    """
    if not scenario.hidden:
        return None
    began = time.process_time()
    split = _split(scenario, records)
    case = CASES[scenario.machine]
    poorer = _declared(case.model(), split)
    richer = poorer
    for one in scenario.hidden:
        richer = _with_truth(richer, one, split, case.truth)
    evidence = compare(poorer.score, richer.score)
    return Oracle(
        gain=evidence.gain,
        p_value=evidence.p_value,
        p_errors=_p_errors(poorer.score, richer.score),
        before=poorer.score.loss,
        after=richer.score.loss,
        error=_errors(scenario, richer.values),
        seconds=time.process_time() - began,
    )


def _p_errors(poorer: Score, richer: Score) -> float:
    """One-sided Student's t over horizons, of the log ratio of their errors over all outputs."""
    before, after = ((s.squares / s.samples / s.scale**2).mean(axis=1) for s in (poorer, richer))
    return float(stats.ttest_1samp(np.log(before / after), 0.0, alternative="greater").pvalue)


def _declared(model: Model, split: Split) -> Refit:
    return refit(model, split, [regressed(model, split)], factors=CONTINUATION)


def _with_truth(poorer: Refit, one: Hidden, split: Split, machine: Mapping[str, float]) -> Refit:
    candidate = Candidate(one.effect, one.port)
    model = candidate.added_to(poorer.model)
    truth = {f"{one.name}.{name}": value for name, value in one.truth.items()}
    starts = candidate.starts(model, poorer.values)
    told = {**starts[0], **machine, **truth}
    return refit(model, split, [told, {**starts[0], **truth}, starts[0]], poorer, poorer.numerics)


def _errors(scenario: Scenario, values: Mapping[str, float]) -> dict[str, float]:
    """Relative error of every true value that is not zero and was fitted: the machine's and the effect's."""
    true = dict(CASES[scenario.machine].truth)
    for one in scenario.hidden:
        true |= {f"{one.name}.{name}": value for name, value in one.truth.items()}
    return {n: abs(values[n] - value) / abs(value) for n, value in true.items() if value and n in values}
