"""Which learned efforts are fitted beside a model that leaves the noise: those that a score test chooses.

What an effort could add to such a model is less than the noise. So little is linear in its amplitudes: one
Gauss-Newton step from zero effort, of all parameters and initial states together, lowers the fitted cost by
as much as a fit would. That needs one simulation, and a fit some fifty. The most promising ones are fitted
whatever they promise: what they take from the held-out error is told. Far from the noise the order is a
guess. It chooses where no name is to be doubted: after a time limit, and for what a report tells of the
declared model.

Source: Rao (1948), Large sample tests of statistical hypotheses, Proc. Camb. Phil. Soc. 44(1), 50-57.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from hybridid.effects.over import Over
from hybridid.estimators.reduced import promise
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import Split
from hybridid.trace.learned.learned_effort import with_learned_effort
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refit import FAILURES
from hybridid.trace.refits.refit_starts import begin, problem_of
from hybridid.trace.refits.refitted import Refit

ALWAYS = 3
"""Learned efforts, the most promising ones, that are fitted in any case."""
Place = tuple[str, Over]


def promising(places: Sequence[Place], base: Refit, context: Context, least: float) -> list[Place]:
    """Those of ``places`` (port and variable) whose learned effort promises ``least``, a share of the fitted
    cost of ``base``, and the ``ALWAYS`` most promising ones, in the order of ``places``."""
    return _chosen(places, _shares(places, base, context), least)


def most_promising(places: Sequence[Place], base: Refit, context: Context) -> list[Place]:
    """As ``promising``: those that promise at least half as much as the best one does."""
    shares = _shares(places, base, context)
    return _chosen(places, shares, max(filter(math.isfinite, shares), default=0.0) / 2)


def _shares(places: Sequence[Place], base: Refit, context: Context) -> list[float]:
    given = [(base, context.split, *place) for place in places]
    return context.each("learned effort, ranked", promised, given)


def _chosen(places: Sequence[Place], shares: Sequence[float], least: float) -> list[Place]:
    ranked = sorted(range(len(places)), key=lambda k: -shares[k])
    return [place for k, place in enumerate(places) if shares[k] >= least or k in ranked[:ALWAYS]]


def promised(base: Refit, split: Split, port: str, over: Over) -> float:
    """The share of the fitted cost of ``base`` that one Gauss-Newton step from zero effort promises, at the
    best of its starts, less what each amplitude takes of white noise by chance: one sample's share. Infinite
    where none can be simulated, which only a fit tells."""
    ours = list(split.fitted)
    model, starts = with_learned_effort(base, Path.of(base, split, split.fitted), port, over)
    by_chance = (len(model.free) - len(base.model.free)) / base.problem(split).on(ours).windows.cells.sum()
    found = []
    for start in starts:
        try:
            problem = problem_of(model, split, base, start)
            begun = begin(problem, model.values(start), base, base.numerics)
            found.append(promise(problem.on(ours), begun.p, begun.x0[ours]))
        except (ValueError, *FAILURES):
            continue
    share = max(found, default=math.inf) / base.cost if base.cost > 0 else math.inf
    return share - float(by_chance)
