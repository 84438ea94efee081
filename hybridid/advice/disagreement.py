"""Recordings of which each is explained far better by parameters of its own.

The load of a lift, the temperature of a bearing or the zero of a sensor may change between two recordings.
One set of parameters then fits neither. So where a fit leaves more than noise and simulation, it is repeated
on each recording alone, from where it ended.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from hybridid.advice.advice import Advice
from hybridid.estimators.estimate import Estimate, EstimatedParameter
from hybridid.estimators.fit import fit
from hybridid.estimators.problem import Problem
from hybridid.naming import listed
from hybridid.quantities import percent, quantity

LEFT = 0.5
"""Of the squared error, that fits to each recording alone leave at most if the recordings disagree."""
APART = 4.0
"""Standard errors by which a parameter that is told differs between two recordings, at least."""
TOLD = 2
"""Parameters that are told, at most."""


def recordings_disagree(problem: Problem, estimate: Estimate) -> Iterator[Advice]:
    """Which parameters differ between the recordings, where values of its own explain each far better."""
    model, records = problem.model, problem.records
    asked = estimate.converged and any(one.exceeded or math.isnan(one.noise) for one in estimate.left)
    if not asked or len(records) < 2 or model.by_record or model.groups:
        return
    settings = replace(estimate.settings, starts=1, substeps=estimate.substeps)
    try:
        alone = [fit(model, [one], settings, start_values=estimate.values) for one in records]
    except ValueError:  # a recording that shows no output, or cannot be fitted alone
        return
    share = _left_by(alone, [one.n for one in records], estimate)
    differ = _differing(alone, [one.name for one in records])
    if share <= LEFT and differ and all(one.converged for one in alone):
        names = listed([name for name, _ in differ])
        yield Advice(
            "recordings",
            f"the recordings disagree: fitted to each alone, the model leaves {percent(_short(share))} of "
            f"the squared error: {'; '.join(said for _, said in differ)}; if {names} may differ (a load, a "
            "temperature, the zero of a sensor), give each recording its own "
            f"({' '.join(f'parameters.{name}.by=record' for name, _ in differ)}); else the model lacks what "
            "makes them differ",
        )


def _left_by(alone: Sequence[Estimate], samples: Sequence[int], together: Estimate) -> float:
    """The squared error that the fits ``alone`` leave over that of all ``together``: of the output of which
    they leave most."""
    squares = np.array([[left.rmse**2 for left in one.left] for one in alone])
    return max(np.average(squares, axis=0, weights=samples) / [left.rmse**2 for left in together.left])


def _differing(alone: Sequence[Estimate], names: Sequence[str]) -> list[tuple[str, str]]:
    """The parameters that differ most between the fits ``alone`` to the recordings ``names``, in standard
    errors, and their lowest and highest values in words."""
    found = []
    for own in zip(*(one.parameters for one in alone), strict=True):
        low, high = (pick(range(len(own)), key=lambda k: own[k].value) for pick in (min, max))
        error = math.hypot(own[low].std, own[high].std)
        apart = (own[high].value - own[low].value) / error if error > 0 else 0.0
        if math.isfinite(apart) and apart >= APART:
            ends = [f"{_said(own[k])} in {names[k]}" for k in (low, high)]
            found.append((apart, own[low].name, f"{own[low].name} is {listed(ends)}"))
    found.sort(key=lambda one: -one[0])
    return [(name, said) for _, name, said in found[:TOLD]]


def _short(share: float) -> float:
    return float(f"{share:.2g}")


def _said(one: EstimatedParameter) -> str:
    return quantity(one.value, one.unit, 4)
