"""The ceiling: how much any memoryless effect at a port could explain.

    F = sum_k w_k exp(-(s - c_k)^2 / (2 width^2)),   s the port's velocity or position

A sum of Gaussian bumps on a fixed grid over the range that the record covers is fitted in
simulation, like any effect, with every other parameter. No effect of velocity alone (or
position alone) can gain more than that on held-out horizons, up to the grid's resolution.
Source: thesis Eqs. 6-4 to 6-6, with fixed centres and widths.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np

from hybridid.effects.dimension import Dimension
from hybridid.effects.effect import Effect, EffectParameter, Local
from hybridid.model import Model
from hybridid.trace.evidence import compare
from hybridid.trace.refit import Refit, refit
from hybridid.trace.split import Split

Over = Literal["velocity", "position"]
BUMPS = 12


@dataclass(frozen=True)
class Ceiling:
    """Held-out ``gain`` of a learned effort at ``port`` over ``over``, with its p-value."""

    port: str
    over: Over
    gain: float
    p_value: float
    curve: tuple[tuple[float, float], ...]
    unit: str
    over_unit: str


@dataclass(frozen=True)
class Bumps:
    """The law of a learned effort: Gaussian bumps at ``centres`` over ``over``."""

    over: Over
    centres: tuple[float, ...]
    width: float

    def __call__(self, at: Local) -> ca.SX:
        s = at.velocity if self.over == "velocity" else at.position
        weights = [getattr(at.p, f"w{k}") for k in range(len(self.centres))]
        return sum(
            w * ca.exp(-(((s - c) / self.width) ** 2) / 2) for w, c in zip(weights, self.centres, strict=True)
        )


def learned_effort(over: Over, low: float, high: float, bumps: int = BUMPS) -> Effect:
    """A learned effort over ``[low, high]`` of the port's velocity or position."""
    centres = tuple(np.linspace(low, high, bumps).tolist())
    width = (high - low) / (bumps - 1)
    weights = tuple(
        EffectParameter(f"w{k}", Dimension(effort=1), f"weight of the bump at {c:.4g}", guess=0.0, nests=True)
        for k, c in enumerate(centres)
    )
    return Effect(
        id=f"learned_{over}",
        kind="effort",
        title=f"learned effort over {over}",
        equation="F = sum_k w_k exp(-(s - c_k)²/(2 width²))",
        law=Bumps(over, centres, width),
        parameters=weights,
        source="thesis Eqs. 6-4 to 6-6 with fixed centres",
        pattern=f"any function of {over}",
    )


def ceiling(base: Refit, split: Split, port: str, over: Over) -> Ceiling:
    """Fit a learned effort at ``port`` beside everything else and score it held out."""
    where = base.model.plant.port(port)
    low, high = _range(base, split, port, over)
    effect = learned_effort(over, low, high)
    model: Model = base.model.plus(effect, port)
    found = refit(model, split, [base.values], base)
    evidence = compare(base.score, found.score)
    grid = np.linspace(low, high, 101)
    weights = np.array([found.values[f"{port}.{effect.id}.w{k}"] for k in range(BUMPS)])
    law = effect.law
    assert isinstance(law, Bumps)
    shapes = np.exp(-(((grid[:, None] - np.array(law.centres)) / law.width) ** 2) / 2)
    unit = where.position_unit + ("/s" if over == "velocity" else "")
    curve = tuple(zip(grid.tolist(), (shapes @ weights).tolist(), strict=True))
    return Ceiling(port, over, evidence.gain, evidence.p_value, curve, where.effort_unit, unit)


def _range(base: Refit, split: Split, port: str, over: Over) -> tuple[float, float]:
    """What the port's motion covers over the records, by the base model's own states."""
    from hybridid.validation.predict import horizon_run

    model = base.model
    index = [q.name for q in model.effort_ports].index(port)
    column = 1 if over == "velocity" else 0
    p = model.values(base.values)
    low, high = np.inf, -np.inf
    for record in split.records:
        run = horizon_run(model, base.values, record, split.horizon)
        n = len(run.time)
        inputs = record.inputs[:n].T
        moved = np.asarray(
            model.motions.map(n)(run.time[None, :], run.states.T, inputs, np.tile(p[:, None], n))
        )
        values = moved[index].reshape(n, 2)[:, column]
        low, high = min(low, float(values.min())), max(high, float(values.max()))
    return low, high
