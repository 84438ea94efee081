"""The ceiling: how much any effect at a port could explain that hangs on one variable.

    F = g sum_j a_j sum_k V_kj exp(-(s - c_k)^2 / (2 width^2))

with s the port's velocity, its position or the time, and g = 1; or, for a damping or a dry friction that
changes from place to place or over the run, g = v or sign(v) and s the position or the time. A dry friction
that follows how much the port has slid of late (it warms) has g = sign(v) and s' = (|v| - s) / tau.

A sum of Gaussian bumps on a fixed grid over the range that the fitted horizons cover is fitted
in simulation, like any effect, with every other parameter. V holds the combinations of bumps
that these horizons show (principal components): a bump where the record hardly ever is would
take any height. No effect of that variable alone can gain more than that on held-out horizons, up
to the grid's resolution. Source: thesis Eqs. 6-4 to 6-6, with fixed
centres and widths; Jolliffe (2002), Principal Component Analysis, ch. 8.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from hybridid.effects.dimension import DAMPING, EFFORT, ONE, POSITION, TIME, VELOCITY, Dimension
from hybridid.effects.effect import Effect, EffectParameter, EffectState, Local
from hybridid.model import Model
from hybridid.trace.evidence import compare
from hybridid.trace.refit import NEVER, Refit, refit
from hybridid.trace.split import Split

Array = NDArray[np.float64]
Over = Literal[
    "velocity",
    "position",
    "time",
    "position, times velocity",
    "time, times velocity",
    "position, times sign of velocity",
    "time, times sign of velocity",
    "speed of late, times sign of velocity",
]
OVERS: tuple[Over, ...] = get_args(Over)
LATE = "speed of late"
DIMENSIONS = {"velocity": VELOCITY, LATE: VELOCITY, "position": POSITION, "time": TIME}
"""Of the s of a learned effort."""
BUMPS, BUMPS_OF_LATE = 12, 3
FAINT = 1e-4
"""Mean square of a combination of bumps over the fitted horizons, against the strongest, below which
they do not show it."""
TOLERANCE = 1e-4
"""Of the fits: what a learned effort could gain need not be known to the last digit."""
AT_ONCE = 1000
"""Samples of a way that CasADi looks at in one call."""
BINS, LEAST_IN_BIN = 60, 20
"""Of the curve that is shown."""


@dataclass(frozen=True)
class Ceiling:
    """Held-out ``gain`` of a learned effort at ``port`` over ``over``, with its p-value.

    ``curve`` (s, effort, samples) is what it adds there to the model's own terms,
    less what these lose in the refit: alone, bumps and viscous friction could trade any amount.
    ``refit`` is the model with it.
    """

    port: str
    over: Over
    gain: float
    p_value: float
    curve: tuple[tuple[float, float, int], ...]
    unit: str
    over_unit: str
    refit: Refit


@dataclass(frozen=True)
class Bumps:
    """The law of a learned effort: ``combinations`` of ``bumps`` Gaussian bumps.

    Where they lie and how they are combined are fixed parameters, so that the compiled model serves every
    record. Beyond its range it stays what it is at the end: nothing has been learned there.
    """

    over: Over
    bumps: int
    combinations: int

    def __call__(self, at: Local) -> ca.SX:
        now = {"velocity": at.velocity, "position": at.position, "time": at.time}
        s = at.z.late if variable(self.over) == LATE else now[variable(self.over)]
        low, high = at.p.first, at.p.last
        s = ca.fmin(ca.fmax(s, low), high)
        bumps = self._heights(((s - low) / (high - low) - 0.5) * (self.bumps - 1))
        effort = 0
        for j in range(self.combinations):
            shape = ca.dot(ca.vertcat(*bumps), ca.vertcat(*(getattr(at.p, v) for v in self._basis(j))))
            effort += getattr(at.p, f"a{j}") * shape
        factors = {"": 1, "times velocity": at.velocity, "times sign of velocity": at.sign}
        return effort * factors[factor(self.over)]

    def _heights(self, s: ca.SX) -> list[ca.SX]:
        """``exp(-(s - c)^2 / 2)`` for the centres c, one apart and 0 in their midst: of two exponentials,

        exp(-s^2 / 2) exp(s)^c exp(-c^2 / 2)
        """
        first = -(self.bumps - 1) / 2
        growing, heights = ca.exp(s), [ca.exp(-((s - first) ** 2) / 2)]
        for k in range(1, self.bumps):
            heights.append(heights[-1] * growing * math.exp(-(first + k) + 0.5))
        return heights

    def _basis(self, j: int) -> list[str]:
        return [f"v{k}_{j}" for k in range(self.bumps)]

    def known(self, low: float, high: float, basis: Array) -> tuple[EffectParameter, ...]:
        """The fixed parameters for bumps from ``low`` to ``high`` combined by ``basis`` (bumps, n)."""

        def fixed(name: str, kind: Dimension, meaning: str, value: float) -> EffectParameter:
            return EffectParameter(name, kind, meaning, guess=value, absolute=True, fixed=True)

        place = DIMENSIONS[variable(self.over)]
        return (
            fixed("first", place, "where the first bump lies", low),
            fixed("last", place, "where the last bump lies", high),
            *(
                fixed(name, ONE, f"share of a bump in combination {j}", float(share))
                for j in range(self.combinations)
                for name, share in zip(self._basis(j), basis[:, j], strict=True)
            ),
        )


def variable(over: str) -> str:
    """The s of a learned effort."""
    return over.partition(",")[0]


def factor(over: Over) -> str:
    """What the function of s is multiplied by; "" for nothing."""
    return over.partition(", ")[2]


def _speed_of_late(at: Local) -> dict[str, ca.SX]:
    return {"late": (at.speed - at.z.late) / at.p.tau}


def _memory(seconds: float) -> EffectParameter:
    return EffectParameter(
        "tau",
        TIME,
        "how long the speed of late is remembered",
        guess=seconds,
        lower=seconds / 30,
        upper=seconds * 30,
        starts=(seconds / 5, seconds * 5),
        absolute=True,
    )


def learned_effort(over: Over, seen: Array, bumps: int = BUMPS, memory: float = 1.0) -> Effect:
    """A learned effort over ``over``, as far as ``seen`` (n,) covers it; what is of late goes back
    ``memory`` seconds, about."""
    low, high = float(seen.min()), float(seen.max())
    law, basis = _combined(over, seen, bumps)
    weights = [
        EffectParameter(
            f"a{j}",
            DAMPING if factor(over) == "times velocity" else EFFORT,
            f"RMS effort of combination {j}",
            guess=0.0,
            nests=True,
        )
        for j in range(law.combinations)
    ]
    late = variable(over) == LATE
    return Effect(
        id="learned_" + over.replace(", ", "_").replace(" ", "_"),
        kind="effort",
        title=f"learned effort over {over}",
        equation={"": "", "times velocity": "v ", "times sign of velocity": "sign(v) "}[factor(over)]
        + "sum_j a_j sum_k V_kj exp(-(s - c_k)²/(2 width²))",
        law=law,
        parameters=(*weights, *((_memory(memory),) if late else ()), *law.known(low, high, basis)),
        states=(EffectState("late", VELOCITY, "speed of late"),) if late else (),
        dynamics=_speed_of_late if late else None,
        source="thesis Eqs. 6-4 to 6-6 with fixed centres",
        pattern=f"any function of {over}",
    )


def _combined(over: Over, seen: Array, bumps: int) -> tuple[Bumps, Array]:
    """The law of those combinations (bumps, n) that ``seen`` (n,) shows, each of mean square one there."""
    places = (seen - seen.min()) / np.ptp(seen) * (bumps - 1)
    shapes = np.exp(-((places[:, None] - np.arange(bumps)) ** 2) / 2)
    spread, components = np.linalg.eigh(shapes.T @ shapes / len(seen))
    shown = spread > FAINT * spread[-1]
    basis = components[:, shown] / np.sqrt(spread[shown])
    return Bumps(over, bumps, basis.shape[1]), basis


def ceiling(base: Refit, split: Split, port: str, over: Over) -> Ceiling:
    """Fit a learned effort at ``port`` beside everything else and score it held out."""
    where = base.model.plant.port(port)
    path = Path.of(base, split, (*split.fitted, *split.held_out))
    fitted = Path.of(base, split, split.fitted)
    bumps = BUMPS_OF_LATE if variable(over) == LATE else BUMPS  # a held-out run may be warmer than any fitted
    effect = learned_effort(over, fitted.motion(port, over), bumps, fitted.memory)
    model: Model = base.model.plus(effect, port)
    starts = _starts(model, effect, port, base)
    found = refit(model, split, starts, base, base.numerics, tolerance=TOLERANCE, doubted=NEVER)
    evidence = compare(base.score, found.score)
    seen = (
        replace(path, states=np.column_stack([path.states, path.motion(port, LATE)]))
        if effect.states
        else path
    )
    net = seen.effort(model, found.values, port) - path.effort(base.model, base.values, port)
    curve = _binned(path.motion(port, over), net)
    over_unit = DIMENSIONS[variable(over)].unit(where)
    return Ceiling(port, over, evidence.gain, evidence.p_value, curve, where.effort_unit, over_unit, found)


def _starts(model: Model, effect: Effect, port: str, base: Refit) -> list[dict[str, float]]:
    """From nothing, with every memory that the learned effort may have."""
    at = model.plant.port(port)
    name = model.terms[-1].name
    memories = [{f"{name}.{p.name}": v} for p in effect.parameters for v in p.starts_at(at)]
    return [{**base.values, **one} for one in ({}, *memories)]


@dataclass(frozen=True)
class Path:
    """The base model's own way through some horizons: times (n,), states (n, n_x), inputs (n, n_u)."""

    model: Model
    p: Array
    time: Array
    states: Array
    inputs: Array

    @classmethod
    def of(cls, base: Refit, split: Split, horizons: Sequence[int]) -> Path:
        p = base.model.values(base.values)
        problem = base.problem(split).on(horizons)
        used = problem.windows.used
        states = problem.shooter(base.x0[list(horizons)], p).states
        return cls(base.model, p, problem.windows.time[used], states[used], problem.windows.inputs[used])

    @property
    def memory(self) -> float:
        """A tenth of the way's duration in s."""
        return float(np.ptp(self.time)) / 10

    def motion(self, port: str, over: str) -> Array:
        """The s of a learned effort over ``over``, (n,)."""
        if variable(over) == "time":
            return self.time
        if variable(over) == LATE:
            share = min(1.0, float(np.median(np.diff(self.time))) / self.memory)
            return np.asarray(lfilter([share], [1.0, share - 1.0], np.abs(self.motion(port, "velocity"))))
        index = [q.name for q in self.model.effort_ports].index(port)
        moved = self._along(self.model.motions, self.p)
        return moved.reshape(len(self.model.effort_ports), -1, 2)[
            index, :, 1 if variable(over) == "velocity" else 0
        ]

    def shows(self, port: str, over: Over) -> bool:
        """Whether what a learned effort over ``over`` works on changes: a port may have no velocity."""
        needed = (variable(over), "velocity") if factor(over) else (over,)
        return all(np.ptp(self.motion(port, one)) > 0 for one in needed)

    def effort(self, model: Model, values: Mapping[str, float], port: str) -> Array:
        """Sum of the efforts of ``model``'s terms at ``port`` along this way, (n,)."""
        terms = [term for term in model.terms if term.effect.kind == "effort"]
        rows = [k for k, term in enumerate(terms) if term.port == port]
        if not rows:
            return np.zeros(len(self.time))
        efforts = self._along(model.efforts, model.values(values))
        return np.asarray(efforts[rows].sum(axis=0))

    def _along(self, function: ca.Function, p: Array) -> Array:
        """``function`` (t, x, u, p) at every sample, its columns stacked."""
        last, found = function.n_in() - 1, []
        for start in range(0, len(self.time), AT_ONCE):
            t, x, u = (a[start : start + AT_ONCE] for a in (self.time, self.states, self.inputs))
            if start == 0 or len(t) < AT_ONCE:
                many = function.map("along", "serial", len(t), [last], [])  # p is not repeated
            found.append(np.asarray(many(t[None, :], x.T, u.T, p)))
        return np.concatenate(found, axis=1)


def _binned(s: Array, effort: Array) -> tuple[tuple[float, float, int], ...]:
    """Means of ``effort`` in bins of ``s`` that hold samples enough, as (s, effort, samples)."""
    edges = np.linspace(s.min(), s.max(), BINS + 1)
    bins = np.clip(np.digitize(s, edges) - 1, 0, BINS - 1)
    members = [bins == k for k in range(BINS)]
    return tuple(
        (float(s[m].mean()), float(effort[m].mean()), int(m.sum()))
        for m in members
        if m.sum() >= LEAST_IN_BIN
    )
