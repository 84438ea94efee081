"""A composed law drawn over the learned effort that it explains, as functions of the same variable."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.effects.over import MEMORIES, Over
from hybridid.trace.ceiling import Ceiling
from hybridid.trace.path import Path
from hybridid.trace.refit import Refit
from hybridid.trace.split import Split

Array = NDArray[np.float64]
BINS, LEAST = 40, 10
"""Of the variable, and the samples that a bin must hold."""


@dataclass(frozen=True)
class LawCurve:
    """What a refit adds at a port as a function of one variable: ``value`` (m,) over ``at`` (m,).

    It is the effort over the factor of ``over``, the changes of the model's own terms included; ``samples``
    (m,) are those of each bin.
    """

    at: Array
    value: Array
    samples: Array


@dataclass(frozen=True)
class LawOverLearned:
    """A law's ``curve`` over that of the ``learned`` effort, both beside the model without them."""

    port: str
    over: Over
    unit: str
    over_unit: str
    curve: LawCurve
    learned: LawCurve


def law_over_learned(base: Refit, law: Refit, learned: Ceiling, split: Split) -> LawOverLearned:
    """The curves of a ``law`` that was refitted beside ``base``, and of the ``learned`` effort there."""
    port = base.model.plant.port(learned.port)
    return LawOverLearned(
        learned.port,
        learned.over,
        learned.over.amplitude.unit(port),
        learned.over_unit,
        _curve(base, law, learned.port, learned.over, split),
        _curve(base, learned.refit, learned.port, learned.over, split),
    )


def _curve(base: Refit, richer: Refit, port: str, over: Over, split: Split) -> LawCurve:
    """In each bin of the variable, the value nearest to effort = value × factor, by least squares."""
    path = Path.of(richer, split, (*split.fitted, *split.held_out))
    own = [state.name for state in richer.model.states]
    poorer = replace(
        path,
        model=base.model,
        p=base.model.values(base.values),
        states=path.states[:, [own.index(state.name) for state in base.model.states]],
    )
    effort = path.effort(richer.model, richer.values, port) - poorer.effort(base.model, base.values, port)
    # of a variable with memory, the last state is that of the law or the learned effort itself
    seen = path.states[:, -1] if over.variable in MEMORIES else poorer.seen(port, over)
    return _binned(seen, effort, poorer.factor(port, over))


def _binned(seen: Array, effort: Array, factor: Array) -> LawCurve:
    edges = np.linspace(seen.min(), seen.max(), BINS + 1)
    bins = np.clip(np.digitize(seen, edges) - 1, 0, BINS - 1)
    found = []
    for k in range(BINS):
        inside = bins == k
        weight = float(np.sum(factor[inside] ** 2))
        if inside.sum() >= LEAST and weight > 0:
            nearest = float(np.sum(effort[inside] * factor[inside])) / weight
            found.append((float(seen[inside].mean()), nearest, float(inside.sum())))
    curve = np.array(found).reshape(-1, 3)
    return LawCurve(curve[:, 0], curve[:, 1], curve[:, 2])
