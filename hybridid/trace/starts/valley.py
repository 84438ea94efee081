"""A fit goes on along its valley: where several parameters change together and the cost hardly does.

A descent creeps along such a valley, or stays where it entered it. So the fit goes on from a place farther
up or down the valley, by a large factor first, then by less. The lowest cost stays. Two effects have one:

- A load behind a play. Each knock of the contact makes the cost rough, and what the records tell well is
  about the product of load and play. So the load changes, the play and the inertia of the machine against it.
- A limit that the input exceeds most of the time. Inertia, friction and limit can be scaled together. So the
  limit changes, and all other parameters with it, by regression. What converged needs no such search.

The gradient at a rough minimum tells too little of how far the valley goes on. So the standard errors of load
and play are at least the distance to the farthest of these fits of which the likelihood is within 1/2 of the
best one.

Source: Hooke, Jeeves (1961), J. ACM 8(2), 212-229 (pattern search); Venzon, Moolgavkar (1988), Applied
Statistics 37(1), 87-94 (intervals by the profile of the likelihood).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from hybridid.estimators.levenberg_marquardt import CONVERGED
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.starts.limit_starts import regressed_beside
from hybridid.trace.starts.load_starts import Giver, giver_of, sought_by

OF_PLAY, OF_LIMIT = (1.25, 1.1, 1.04), (2.0, 1.4, 1.2, 1.1)
"""By which the load, or the limit, is changed, one after the other."""
MOST = 4
"""Steps by one factor."""
Start = Mapping[str, float]
Move = Callable[[Refit, float], Start | None]
"""Values by name so many times farther along the valley than a refit; None beyond a bound."""


def has_valley(found: Refit, candidate: Candidate) -> bool:
    """Whether the refit of ``candidate`` may go on along a valley."""
    play, load, limit = (sought_by(candidate, what) for what in ("play", "load", "limit"))
    return bool((play and load) or (limit and found.status != CONVERGED))


def along_the_valley(found: Refit, candidate: Candidate, base: Refit, split: Split) -> Refit:
    """``found``, or the refit with the lowest cost along its valley. What has none stays."""
    if not has_valley(found, candidate):
        return found
    play, load, limit = (sought_by(candidate, what) for what in ("play", "load", "limit"))
    if limit:
        own = [name for name in found.values if name.startswith(f"{candidate.name}.")]
        return _search(found, OF_LIMIT, lambda one, by: _with_limit(one, own, limit, by, split), split)[0]
    giver = giver_of(candidate.port, base, split)
    if giver is None:
        return found
    seen = _search(found, OF_PLAY, lambda one, by: _with_load(one, giver, load, play, by), split)
    return _as_wide_as_the_valley(seen[0], seen, (giver.name, load, play), split)


def _search(found: Refit, factors: Sequence[float], move: Move, split: Split) -> list[Refit]:
    """``found`` and all refits along the valley, the lowest cost first, with standard errors. Where a step
    pays, the next one goes the same way: what lies the other way is known."""
    first, seen = found, [found]
    for factor in factors:
        ways: tuple[float, ...] = (factor, 1 / factor)
        for _ in range(MOST):
            tried = {by: _from(found, move(found, by), split) for by in ways}
            made = {by: one for by, one in tried.items() if one is not None}
            seen += made.values()
            way = min(made, key=lambda by: made[by].cost, default=None)
            if way is None or made[way].cost >= found.cost:
                break
            found, ways = made[way], (way,)
    best, *others = sorted(seen, key=lambda one: one.cost)
    return [best if best is first else _with_std(best, split), *others]


def _from(found: Refit, start: Start | None, split: Split) -> Refit | None:
    """``found`` refitted from ``start``, if there is one, without standard errors."""
    return None if start is None else refit_if_possible(found.model, split, [start], found, found.numerics)


def _with_std(found: Refit, split: Split) -> Refit:
    """``found`` with standard errors, gone on to where it converges."""
    return refit_if_possible(found.model, split, [found.values], found, found.numerics, math.inf) or found


def _with_load(found: Refit, giver: Giver, load: str, play: str, by: float) -> Start | None:
    changed = found.values[load] * by
    left = found.values[giver.name] - giver.value_of(changed - found.values[load])
    changes = {giver.name: left, load: changed, play: found.values[play] / by}
    declared = {p.name: p for p in found.model.parameters}
    inside = all(declared[name].lower < value < declared[name].upper for name, value in changes.items())
    return {**found.values, **changes} if inside else None


def _with_limit(found: Refit, own: Sequence[str], limit: str, by: float, split: Split) -> Start | None:
    known = {**{name: found.values[name] for name in own}, limit: found.values[limit] / by}
    return regressed_beside(known, found.model, split)


def _as_wide_as_the_valley(found: Refit, seen: Sequence[Refit], names: Sequence[str], split: Split) -> Refit:
    """``found`` with standard errors of ``names`` that reach the fits ``seen`` that are as likely."""
    n = int(found.problem(split).on(split.fitted).windows.cells.sum())
    near = [one for one in seen if n * (one.cost / found.cost - 1) <= 1]
    reach = {name: max(abs(one.values[name] - found.values[name]) for one in near) for name in names}
    return replace(found, std={name: max(s, reach.get(name, 0.0)) for name, s in found.std.items()})
