"""A load behind a play, fitted along its valley: from other loads, the product of load and play kept.

Each knock of the contact makes the cost rough, and a descent hardly leaves the load with which it began. What
the records tell well is about the product of load and play. So the fit goes on from a load that is larger or
smaller by a quarter, then by less, with the play and the inertia of the machine changed against it. The
lowest cost stays.

The gradient at a rough minimum tells too little of how far the valley goes on. So the standard errors are at
least the distance to the farthest of these fits of which the likelihood is within 1/2 of the best one.

Source: Hooke, Jeeves (1961), J. ACM 8(2), 212-229 (pattern search); Venzon, Moolgavkar (1988), Applied
Statistics 37(1), 87-94 (intervals by the profile of the likelihood).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hybridid.trace.candidates import Candidate
from hybridid.trace.load_starts import Giver, giver_of, sought_by
from hybridid.trace.refit import Refit, refit_if_possible
from hybridid.trace.split import Split

FACTORS = (1.25, 1.1, 1.04)
"""By which the load is changed, one after the other."""
MOST = 4
"""Steps by one factor."""


def along_the_valley(found: Refit, candidate: Candidate, base: Refit, split: Split, least: float) -> Refit:
    """``found``, or the refit with the lowest cost along the valley. What has no play, or takes less than the
    share ``least`` from the held-out error of ``base``, stays."""
    play, load = (sought_by(candidate, what) for what in ("play", "load"))
    if not (play and load) or found.score.loss > (1 - least) * base.score.loss:
        return found
    giver = giver_of(candidate.port, base, split)
    if giver is None:
        return found
    seen = [found]
    for factor in FACTORS:
        for _ in range(MOST):
            tried = [_from(found, giver, load, play, by, split) for by in (factor, 1 / factor)]
            seen += (one for one in tried if one is not None)
            best = min(seen, key=lambda one: one.cost)
            if best is found:
                break
            found = best
    return _as_wide_as_the_valley(found, seen, (giver.name, load, play), split)


def _as_wide_as_the_valley(found: Refit, seen: Sequence[Refit], names: Sequence[str], split: Split) -> Refit:
    """``found`` with standard errors of ``names`` that reach the fits ``seen`` that are as likely."""
    n = int(found.problem(split).on(split.fitted).windows.cells.sum())
    near = [one for one in seen if n * (one.cost / found.cost - 1) <= 1]
    reach = {name: max(abs(one.values[name] - found.values[name]) for one in near) for name in names}
    return replace(found, std={name: max(s, reach.get(name, 0.0)) for name, s in found.std.items()})


def _from(found: Refit, giver: Giver, load: str, play: str, by: float, split: Split) -> Refit | None:
    """``found`` refitted from ``by`` times the load; None beyond a bound."""
    changed = found.values[load] * by
    left = found.values[giver.name] - giver.value_of(changed - found.values[load])
    changes = {giver.name: left, load: changed, play: found.values[play] / by}
    declared = {p.name: p for p in found.model.parameters}
    if not all(declared[name].lower < value < declared[name].upper for name, value in changes.items()):
        return None
    start = {**found.values, **changes}
    return refit_if_possible(found.model, split, [start], found, found.numerics, float("inf"))
