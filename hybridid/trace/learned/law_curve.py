"""A composed law drawn over the learned effort that it explains, as functions of the same variable."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hybridid.effects.over import MEMORIES, Over
from hybridid.trace.horizons.split import Split
from hybridid.trace.learned.ceiling import Ceiling
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refitted import Refit

Array = NDArray[np.float64]
BINS, LEAST = 40, 10
"""Of the variable at most, and the samples that a bin must hold. A short record has fewer bins."""
BINS_A_TERM = 3
"""So many bins at least for each of the model's own terms, or these would meet any curve."""
ONE_CURVE = 0.9
"""The least share of an effort's mean square that its own curve must explain for it to be one."""


@dataclass(frozen=True)
class LawCurve:
    """An effort at a port, over the factor of an ``Over``, as a function of its variable.

    ``value`` (m,) over ``at`` (m,); ``samples`` (m,) are those of each bin.
    """

    at: Array
    value: Array
    samples: Array

    def over(self, seen: Array) -> Array:
        """The curve (n,) at the values ``seen`` (n,) of the variable, straight between its points; zero if it
        has none."""
        return np.interp(seen, self.at, self.value) if len(self.at) else np.zeros_like(seen)


@dataclass(frozen=True)
class LawOverLearned:
    """A law's formula as a ``curve``, and that of the ``learned`` effort that it explains.

    Two fits share one effort differently among the model's own terms and what is added. So ``learned`` is
    known up to what these can take over: a constant, inertia, damping, stiffness and each declared effect, as
    far as each is a curve over the same variable. It is shown where it comes nearest to the law, or as it was
    fitted if the variable takes few values only.

    ``value`` says what is shown: an effort over the factor, or an amplitude
    (``hybridid.trace.laws.level_curve``).
    """

    port: str
    over: Over
    unit: str
    over_unit: str
    curve: LawCurve
    learned: LawCurve
    value: Literal["effort", "amplitude"] = "effort"


def law_over_learned(base: Refit, law: Refit, learned: Ceiling, split: Split) -> LawOverLearned:
    """The curves of a ``law`` that was refitted beside ``base``, and of the ``learned`` effort there."""
    port, over = learned.port, learned.over
    curve = _law_curve(base, law, port, over, split)
    return LawOverLearned(
        port,
        over,
        over.amplitude.unit(base.model.plant.port(port)),
        learned.over_unit,
        curve,
        _learned_curve(base, learned, curve, split),
    )


def _law_curve(base: Refit, law: Refit, port: str, over: Over, split: Split) -> LawCurve:
    """The law alone, without the model's own terms."""
    path, own = _path(base, law, split)
    efforts = path.efforts(law.model, law.values, port)
    added = efforts[len(own.efforts(base.model, base.values, port)) :].sum(axis=0)
    return binned(_seen(path, own, port, over), added, own.factor(port, over))


def is_curve_over(refitted: Refit, name: str, port: str, over: Over, split: Split) -> bool:
    """Whether the effort of the term ``name`` at ``port`` is a curve over ``over``, times its factor."""
    return share_over(refitted, name, port, over, split) >= ONE_CURVE


def share_over(refitted: Refit, name: str, port: str, over: Over, split: Split) -> float:
    """The share of the mean square of the effort of the term ``name`` at ``port`` that a curve over ``over``,
    times its factor, explains.

    Over a variable with memory, nothing but a law of that variable is a curve: there it is 0.
    """
    if over.variable in MEMORIES:
        return 0.0
    path = Path.of(refitted, split, (*split.fitted, *split.held_out))
    effort = path.effort_of(name, port)
    seen, factor = path.seen(port, over), path.factor(port, over)
    return _share(effort, binned(seen, effort, factor), seen, factor)


def _learned_curve(base: Refit, learned: Ceiling, law: LawCurve, split: Split) -> LawCurve:
    """All that the learned effort changed, less what the model's own terms take over to be near ``law``."""
    port, over = learned.port, learned.over
    path, own = _path(base, learned.refit, split)
    terms = own.efforts(base.model, base.values, port)
    change = path.effort(learned.refit.model, learned.refit.values, port) - terms.sum(axis=0)
    motion = [own.motion(port, "position"), own.motion(port, "velocity")]
    if base.model.plant.port(port).kind == "effort":
        motion.append(own.factor(port, Over("position", "acceleration")))
    seen, factor = _seen(path, own, port, over), own.factor(port, over)
    curve = binned(seen, change, factor)
    efforts = (np.ones_like(change), *motion, *terms)
    own_curves = ((effort, binned(seen, effort, factor)) for effort in efforts)
    kept = [one.value for effort, one in own_curves if _share(effort, one, seen, factor) >= ONE_CURVE]
    columns = np.array(kept).reshape(-1, len(curve.at)).T
    if len(columns) < BINS_A_TERM * columns.shape[1]:
        return curve
    weight = np.sqrt(curve.samples)
    apart = curve.value - law.over(curve.at)
    shares, *_ = np.linalg.lstsq(columns * weight[:, None], apart * weight, rcond=1e-9)
    return replace(curve, value=curve.value - columns @ shares)


def _share(effort: Array, curve: LawCurve, seen: Array, factor: Array) -> float:
    """The share of ``effort`` (n,) that follows from the variable and the factor alone; 1 of none at all."""
    rest, all_of_it = effort - curve.over(seen) * factor, float(effort @ effort)
    return 1 - float(rest @ rest) / all_of_it if all_of_it > 0 else 1.0


def _path(base: Refit, richer: Refit, split: Split) -> tuple[Path, Path]:
    """The path of ``richer``, and the same as the model of ``base`` sees it."""
    path = Path.of(richer, split, (*split.fitted, *split.held_out))
    names = [state.name for state in richer.model.states]
    states = path.states[:, [names.index(state.name) for state in base.model.states]]
    return path, replace(path, model=base.model, p=base.model.values(base.values), states=states)


def _seen(path: Path, own: Path, port: str, over: Over) -> Array:
    """The variable; one with memory is the last state of the richer model."""
    return path.states[:, -1] if over.variable in MEMORIES else own.seen(port, over)


def binned(seen: Array, effort: Array, factor: Array) -> LawCurve:
    """What ``effort`` (n,) is over ``factor`` (n,), by least squares in bins of ``seen`` (n,)."""
    count = int(np.clip(len(seen) // (2 * LEAST), 1, BINS))
    edges = np.linspace(seen.min(), seen.max(), count + 1)
    bins = np.clip(np.digitize(seen, edges) - 1, 0, count - 1)
    found = []
    for k in range(count):
        inside = bins == k
        weight = float(np.sum(factor[inside] ** 2))
        if inside.sum() >= LEAST and weight > 0:
            nearest = float(np.sum(effort[inside] * factor[inside])) / weight
            found.append((float(seen[inside].mean()), nearest, float(inside.sum())))
    curve = np.array(found).reshape(-1, 3)
    return LawCurve(curve[:, 0], curve[:, 1], curve[:, 2])
