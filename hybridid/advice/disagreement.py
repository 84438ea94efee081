"""Recordings that one set of parameters does not fit, and few parameters of their own do.

The load of a lift, the temperature of a bearing or the zero of a sensor may change between two recordings.
So where a fit leaves more than noise and simulation, it is repeated on each recording alone, from where it
ended. If these fits leave far less, the one or two parameters that differ most between them, in standard
errors, get a value for each recording, and all are fitted together once more. What a model lacks may bend all
parameters of each recording: then these few do not suffice, and nothing is told.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hybridid.advice.advice import Advice
from hybridid.estimators.estimate import Estimate
from hybridid.estimators.fit import fit
from hybridid.estimators.problem import Problem
from hybridid.model import Model
from hybridid.model.groups import WEIGHT, of_group
from hybridid.naming import listed
from hybridid.quantities import percent, quantity
from hybridid.records.record import Record
from hybridid.settings.fit import FitSettings

LEFT = 0.5
"""Of the error, that a fit with more parameters leaves at most if they are needed."""
APART = 4.0
"""Standard errors by which a parameter that is told differs between two recordings, at least."""
MOST = 2
"""Parameters that are told."""
LONGEST = 30.0
"""Seconds of a fit that is repeated on each recording, which takes about as long again."""


@dataclass(frozen=True)
class Disagreement:
    """With values of its own for each recording, a few parameters leave the ``share`` of the RMS error that
    is left with one for all; ``said`` tells which and with which values, in words. It ``suffices`` if no more
    than noise and simulation is left. ``settings`` give each recording its own, in words of a command."""

    share: float
    said: str
    suffices: bool
    settings: tuple[str, ...]


def recordings_disagree(problem: Problem, estimate: Estimate) -> Iterator[Advice]:
    """Which parameters differ between the recordings, where values of its own explain each far better."""
    if found := disagreement(problem.model, problem.records, estimate):
        yield Advice("recordings", found.said)


def disagreement(
    model: Model, records: Sequence[Record], estimate: Estimate, most: float = LEFT
) -> Disagreement | None:
    """The parameters of ``model`` that differ between ``records``, where their fit, the ``estimate``, leaves
    more than noise and simulation, and values of its own explain each recording far better: they leave the
    share ``most`` of the error at most; else None. With all parameters its own, a recording leaves least."""
    poor = estimate.converged and any(one.exceeded or math.isnan(one.noise) for one in estimate.left)
    long = estimate.seconds.get("solve", 0.0) > LONGEST
    if not poor or long or len(records) < 2 or model.by_record or model.groups:
        return None
    settings = replace(estimate.settings, method="gauss_newton", starts=1, substeps=estimate.substeps)
    try:
        alone = [fit(model, [one], settings, start_values=estimate.values) for one in records]
        names = _differing(alone) if share_left(alone, estimate, records) <= most else []
        own = [_with_own(names[:k], model, alone, records, settings) for k in range(1, len(names) + 1)]
    except ValueError:  # a recording that shows no output, or cannot be fitted
        return None
    shares = [share_left([one], estimate) if one.converged else 1.0 for one in own]
    needed = [k for k, share in enumerate(shares) if share <= LEFT * min([1.0, *shares[:k]])]
    if not needed or shares[needed[-1]] > most:
        return None
    told = needed[-1]
    suffices = not any(one.exceeded or math.isnan(one.noise) for one in own[told].left)
    words = _settings(names[: told + 1])
    said = _said(names[: told + 1], own[told], shares[told], records, words)
    return Disagreement(shares[told], said, suffices, words)


def share_left(fits: Sequence[Estimate], together: Estimate, records: Sequence[Record] = ()) -> float:
    """The RMS error that ``fits``, one for each of ``records`` (none: one for all), leave over that of all
    ``together``: of the output of which they leave most."""
    squares = np.array([[left.rmse**2 for left in one.left] for one in fits])
    mean = np.average(squares, axis=0, weights=[one.n for one in records] or None)
    return float(np.sqrt(np.max(mean / [left.rmse**2 for left in together.left])))


def _differing(alone: Sequence[Estimate]) -> list[str]:
    """The parameters that differ most between the fits ``alone`` to each recording, in standard errors."""
    apart = {}
    for own in zip(*(one.parameters for one in alone), strict=True):
        low, high = (pick(own, key=lambda one: one.value) for pick in (min, max))
        error = math.hypot(low.std, high.std)
        apart[low.name] = (high.value - low.value) / error if error > 0 else 0.0
    found = [name for name in sorted(apart, key=lambda name: -apart[name]) if apart[name] >= APART]
    return found[:MOST]


def _with_own(
    names: Sequence[str],
    model: Model,
    alone: Sequence[Estimate],
    records: Sequence[Record],
    settings: FitSettings,
) -> Estimate:
    """The fit with a value of each of the parameters ``names`` for each of ``records``."""
    recordings = tuple(one.name for one in records)
    start = {
        of_group(name, own): fitted.values[name]
        for name in names
        for own, fitted in zip(recordings, alone, strict=True)
    }
    weighted = []
    for record in records:
        weights = {of_group(name, own): float(own == record.name) for name in names for own in recordings}
        weighted.append(record.with_constants(weights, dict.fromkeys(weights, WEIGHT)))
    common = [p.name for p in model.free if p.name not in names]
    start |= {name: float(np.mean([one.values[name] for one in alone])) for name in common}
    own = replace(model, groups=dict.fromkeys(names, recordings))
    return fit(own, weighted, settings, start_values=start)


def _settings(names: Sequence[str]) -> tuple[str, ...]:
    """What gives each recording values of its own. One that is held out would have none."""
    return *(f"parameters.{name}.by=record" for name in names), "fit.records=null", "trace.held_out=null"


def _said(
    names: Sequence[str],
    own: Estimate,
    share: float,
    records: Sequence[Record],
    settings: Sequence[str],
) -> str:
    known = {p.name: p for p in own.parameters}
    told = []
    for name in names:
        each = {one.name: known[of_group(name, one.name)] for one in records}
        ends = [pick(each, key=lambda one: each[one].value) for pick in (min, max)]
        said = [f"{quantity(each[end].value, each[end].unit, 4)} in {end}" for end in ends]
        told.append(f"{name} is {listed(said)}")
    left = percent(float(f"{share:.2g}"))
    return (
        f"the recordings disagree: if each has its own {listed(names)}, the model leaves {left} of the "
        f"error: {'; '.join(told)}; if that may differ (a load, a temperature, the zero of a sensor), go on "
        f"with {' '.join(settings)}, which fits every recording with a value of its own; else the model "
        "lacks what makes it differ"
    )
