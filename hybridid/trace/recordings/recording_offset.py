"""Whether a constant effort that differs by recording makes most of the error: a preload, a zero, a slope.

Beside the last model, let g_h be the derivative of the outputs of horizon h by a constant effort at a port,
and e_h the errors there, both less what the initial state of the horizon can do. The effort that horizon h
asks for, and its weight, are

    a_h = g_h' e_h / W_h,   W_h = g_h' g_h.

With a_r the weighted mean of recording r and a that of all, the recordings differ by sum_r W_r (a_r - a)^2. A
one-way analysis of variance compares this with the scatter within the recordings. Neighbouring horizons may
go together, so significance alone proves little: it must also be most of the squared error.

No effect with one amplitude for all recordings explains such an error. Source: Fisher (1925), Statistical
Methods for Research Workers, ch. 7.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from hybridid.effects.library import effect_named
from hybridid.naming import listed
from hybridid.quantities import quantity, share
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit import FAILURES
from hybridid.trace.refits.refit_starts import begin, problem_of
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.trials.sensitivity import linearised, without

Array = NDArray[np.float64]
OFFSET = "offset"
TOLD = 5
"""Recordings of which the effort is told."""


@dataclass(frozen=True, eq=False)
class _Asked:
    """The effort (w,) that each horizon asks for at a port, its weight (w,), the recording (w,) of each, and
    the squared error of all."""

    effort: Array
    weight: Array
    recording: NDArray[np.str_]
    squares: float

    @cached_property
    def means(self) -> dict[str, float]:
        """The effort that each recording asks for."""
        return {str(r): self._mean(self.recording == r) for r in dict.fromkeys(self.recording)}

    @property
    def between(self) -> float:
        """What the recordings' own efforts take from the squared error, beside one that all share."""
        common = self._mean(slice(None))
        return sum(
            float(self.weight[self.recording == r].sum()) * (mean - common) ** 2
            for r, mean in self.means.items()
        )

    @property
    def p_value(self) -> float:
        """Of recordings that ask for one effort: of F."""
        free, left = len(self.means) - 1, len(self.effort) - len(self.means)
        own = np.array([self.means[r] for r in self.recording])
        within = float(self.weight @ np.square(self.effort - own))
        if free < 1 or left < 1 or within <= 0:
            return 1.0
        return float(stats.f.sf(self.between / free / (within / left), free, left))

    def _mean(self, at: NDArray[np.bool_] | slice) -> float:
        return float(np.average(self.effort[at], weights=self.weight[at]))


def offset_by_recording(final: Refit, split: Split, rules: Rules) -> str:
    """At which port the recordings ask for another constant effort each, in words; empty if at none. Parts of
    one file are one recording."""
    names = {record.digest or record.name: record.name for record in reversed(split.records)}
    if len(names) < 2:
        return ""
    present = {term.name for term in final.model.terms}
    for port in final.model.equation_ports:
        one = Candidate(effect_named(OFFSET), port.name)
        asked = None if one.name in present else _asked(one, final, split)
        if asked and asked.between >= rules.majority * asked.squares and asked.p_value <= rules.alpha:
            return _said(one, asked, names, port.effort_unit)
    return ""


def _said(one: Candidate, asked: _Asked, names: dict[str, str], unit: str) -> str:
    each = [f"{quantity(mean, unit)} in {names[r]}" for r, mean in asked.means.items()]
    more = [] if len(each) <= TOLD else [f"others in {len(each) - TOLD} more"]
    return (
        f" A constant effort at {one.port} that differs by recording ({listed([*each[:TOLD], *more])}) makes "
        f"{share(asked.between / asked.squares)} of the squared error. A preload, a slope or a zero may "
        f"differ: the effect {OFFSET} with parameters.{one.name}.{OFFSET}.by=record fits one for each."
    )


@np.errstate(all="ignore")  # a horizon may diverge: then nothing is said
def _asked(one: Candidate, final: Refit, split: Split) -> _Asked | None:
    """What each horizon that ``one`` moves asks for; None if the model cannot be simulated with it."""
    name = f"{one.name}.{OFFSET}"
    try:
        model, values = one.added_to(final.model), {**final.values, name: 0.0}
        problem = problem_of(model, split, final, values)
        begun = begin(problem, model.values(values), final, final.numerics)
        by, error = linearised(problem.estimating((name,)), begun.p, begun.x0)
    except (ValueError, *FAILURES):
        return None
    states = by[:, : len(model.states)] * problem.moving[:, :, None]
    if not (np.isfinite(by).all() and np.isfinite(error).all()):
        return None
    own, left = without(np.stack([by[:, -1], error], axis=1), states).swapaxes(0, 1)
    records = [split.records[record] for record, *_ in problem.windows.origin]
    weight = np.square(own).sum(axis=1)
    moved = weight > 0
    return _Asked(
        effort=(own * left).sum(axis=1)[moved] / weight[moved],
        weight=weight[moved],
        recording=np.array([record.digest or record.name for record in records])[moved],
        squares=float(np.square(left).sum()),
    )
