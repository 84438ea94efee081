"""The whole trace: search, class re-check, ceilings, verdict."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from hybridid.effects.effect import Effect
from hybridid.estimators.start import regression_start
from hybridid.model import Model
from hybridid.trace.ceiling import OVERS, Ceiling, Path, ceiling
from hybridid.trace.mapper import Mapper, serial
from hybridid.trace.noise import noise_level
from hybridid.trace.numerics import Numerics
from hybridid.trace.refit import Refit
from hybridid.trace.robustness import lasting
from hybridid.trace.rules import Rules
from hybridid.trace.search import Accepted, Report, Search, recheck, search
from hybridid.trace.split import Split
from hybridid.trace.stand_in import unless_outdone, without_stand_ins

MOST_TOLD = 3
"""Places where structure remains, the strongest, that are looked at and named."""
Ceilings = tuple[Ceiling, ...]
Verdict = Literal["effect_found", "ambiguous", "nothing_missing", "unexplained"]


@dataclass(frozen=True)
class Trace:
    """What was found, by which path, and what remains.

    ``floor`` is the noise level of each output, in its unit; ``ceilings`` the held-out gain
    that a learned effort could still bring to the last model, by port and variable,
    ``ceilings_before`` to the declared one (empty where it was not needed: fewer than two effects).
    ``remains`` names where structure is left that no effect of the library explains.
    """

    verdict: Verdict
    search: Search
    floor: Mapping[str, float]
    ceilings: Ceilings
    ceilings_before: Ceilings
    remains: tuple[str, ...]

    @property
    def model(self) -> Model:
        return self.search.final.model

    @property
    def accepted(self) -> tuple[Accepted, ...]:
        return self.search.accepted


def trace(
    model: Model,
    split: Split,
    effects: Sequence[Effect],
    rules: Rules | None = None,
    start: Sequence[Mapping[str, float]] | None = None,
    mapper: Mapper = serial,
    report: Report = lambda stage, done, of, what: None,
    ports: Sequence[str] | None = None,
    integrator: str = "rk4",
) -> Trace:
    """Find what ``model`` lacks on the records of ``split``.

    ``effects`` are tried at every port of their kind (or only at ``ports``); ``mapper``
    runs refits, in parallel if it likes; ``report(stage, done, of, what)`` follows them;
    ``integrator`` solves the equations, and the other one checks it.

    Raises:
        ValueError: if a record does not fit the model or it diverges on the records.
    """
    rules = rules or Rules()
    began = [dict(s) for s in start] if start else [regressed(model, split)]
    noise = np.max([noise_level(record) for record in split.records], axis=0)
    spread = np.concatenate([record.outputs for record in split.records]).std(axis=0)
    floor = float(np.sqrt(np.mean((noise / np.where(spread > 0, spread, 1.0)) ** 2)))
    numerics = Numerics(integrator=integrator)
    found = search(model, split, effects, began, floor, rules, mapper, report, ports, numerics)
    found = recheck(found, split, rules)
    found, ceilings, before = _trusted(
        found, split, rules, mapper, lambda model: _ceilings(model, split, mapper, report, ports)
    )
    told = _telling(ceilings, rules)[:MOST_TOLD]
    lasts = lasting([c.refit for c in told], found.final, split, rules, mapper)
    remains = tuple(f"at {told[k].port} over {told[k].over}" for k in lasts)
    return Trace(
        verdict=_verdict(found, remains),
        search=found,
        floor={s.name: float(v) for s, v in zip(model.outputs, noise, strict=True)},
        ceilings=ceilings,
        ceilings_before=before,
        remains=remains,
    )


def regressed(model: Model, split: Split) -> dict[str, float]:
    """Parameter values to start from: by regression on the fitted records, else the guesses."""
    records = [split.records[k] for k in sorted({_record_of(split, h) for h in split.fitted})]
    start = regression_start(model, records)
    values = model.values() if start is None else start
    return {q.name: float(v) for q, v in zip(model.parameters, values, strict=True)}


def _record_of(split: Split, horizon: int) -> int:
    counts = np.cumsum([-(-record.n // split.horizon) for record in split.records])
    return min(int(np.searchsorted(counts, horizon, side="right")), len(split.records) - 1)


def _trusted(
    found: Search, split: Split, rules: Rules, mapper: Mapper, look: Callable[[Refit], Ceilings]
) -> tuple[Search, Ceilings, Ceilings]:
    """``found`` less what stands in for something else, with the ceilings of its last model, and of the
    declared one if several effects had to be held against them."""
    before = look(found.first) if len(found.accepted) > 1 else ()
    kept = unless_outdone(found, before, rules)
    if kept is not found:
        return kept, before, before
    ceilings = look(found.final)
    kept = without_stand_ins(found, split, ceilings, rules, mapper)
    return kept, (ceilings if kept is found else look(kept.final)), before


def _ceilings(
    model: Refit, split: Split, mapper: Mapper, report: Report, ports: Sequence[str] | None
) -> Ceilings:
    path = Path.of(model, split, split.fitted)
    places = [
        (model, split, port.name, over)
        for port in model.model.effort_ports
        if ports is None or port.name in ports
        for over in OVERS
        if path.shows(port.name, over)
    ]
    made = []
    for one in mapper(ceiling, places):
        made.append(one)
        report("ceiling", len(made), len(places), f"{one.port} over {one.over}")
    return tuple(made)


def _telling(ceilings: Sequence[Ceiling], rules: Rules) -> list[Ceiling]:
    """The learned efforts that still find something, the best first; not those that find less than half of
    what the best does: over the wrong variable a little of everything can be found."""
    found = [c for c in ceilings if c.gain >= rules.worth and c.p_value <= rules.alpha]
    most = max((c.gain for c in found), default=0.0)
    return sorted((c for c in found if c.gain >= most / 2), key=lambda c: -c.gain)


def _verdict(found: Search, remains: Sequence[str]) -> Verdict:
    """One word: an effect found alone, found in a class, something left unnamed, or nothing."""
    if found.accepted:
        return "ambiguous" if any(len(one.alike) > 1 for one in found.accepted) else "effect_found"
    return "unexplained" if remains else "nothing_missing"
