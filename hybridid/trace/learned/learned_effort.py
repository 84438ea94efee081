"""A learned effort: any function of one variable, as a sum of Gaussian bumps.

    F = g sum_j a_j sum_k V_kj exp(-(s - c_k)^2 / (2 width^2))

with s a variable of the port and g = 1; or, for a damping or a dry friction that changes with s, g = v or
sign(v). An inertia that changes with the position is learned as well: F follows from it by Lagrange's
equation (``hybridid.effects.over``). At a flow port, F is a learned flow.

The bumps lie on a fixed grid over the range that the fitted horizons cover. V holds the combinations of
bumps that these horizons show (principal components): a bump where the record hardly ever is would take any
height. Source: thesis Eqs. 6-4 to 6-6, with fixed centres and widths; Jolliffe (2002), Principal Component
Analysis, ch. 8.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.declarations import PortKind
from hybridid.effects.dimension import ONE, Dimension
from hybridid.effects.effect import Effect, EffectParameter, Local
from hybridid.effects.over import BRISTLE, MEMORIES, Over, effort_of, equation_of
from hybridid.model import Model
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refitted import Refit

Array = NDArray[np.float64]
FAINT = 1e-4
"""Mean square of a combination of bumps over the fitted horizons, against the strongest, below which
they do not show it."""


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
        low, high = at.p.first, at.p.last

        def learned(s: ca.SX) -> ca.SX:
            s = ca.fmin(ca.fmax(s, low), high)
            bumps = self._heights(((s - low) / (high - low) - 0.5) * (self.bumps - 1))
            return ca.dot(ca.vertcat(*bumps), self._amplitudes(at))

        return effort_of(self.over, at, learned)

    def _heights(self, s: ca.SX) -> list[ca.SX]:
        """``exp(-(s - c)^2 / 2)`` for centres c one apart, with 0 in the middle. It needs two exponentials:

        exp(-s^2 / 2) exp(s)^c exp(-c^2 / 2)
        """
        first = -(self.bumps - 1) / 2
        growing, heights = ca.exp(s), [ca.exp(-((s - first) ** 2) / 2)]
        for k in range(1, self.bumps):
            heights.append(heights[-1] * growing * math.exp(-(first + k) + 0.5))
        return heights

    def _amplitudes(self, at: Local) -> ca.SX:
        """``sum_j a_j V_kj`` of each bump, (bumps,): it depends on parameters alone."""
        combined = ca.SX.zeros(self.bumps)
        for j in range(self.combinations):
            basis = ca.vertcat(*(getattr(at.p, v) for v in self._basis(j)))
            combined += getattr(at.p, f"a{j}") * basis
        return combined

    def _basis(self, j: int) -> list[str]:
        return [f"v{k}_{j}" for k in range(self.bumps)]

    def known(self, low: float, high: float, basis: Array) -> tuple[EffectParameter, ...]:
        """The fixed parameters for bumps from ``low`` to ``high`` combined by ``basis`` (bumps, n)."""

        def fixed(name: str, kind: Dimension, meaning: str, value: float) -> EffectParameter:
            return EffectParameter(name, kind, meaning, guess=value, absolute=True, fixed=True)

        place = self.over.dimension
        return (
            fixed("first", place, "where the first bump lies", low),
            fixed("last", place, "where the last bump lies", high),
            *(
                fixed(name, ONE, f"share of a bump in combination {j}", float(share))
                for j in range(self.combinations)
                for name, share in zip(self._basis(j), basis[:, j], strict=True)
            ),
        )


def learned_effort(
    kind: PortKind, over: Over, seen: Array, bumps: int | None = None, remembers: float = 1.0
) -> Effect:
    """A learned effort or flow, by the ``kind`` of port, over ``over``, on the range of ``seen`` (n,).

    ``bumps`` defaults to ``over.bumps``. ``remembers`` is the guess of a variable's memory: the time constant
    [s] of a recent speed, the length over which a bristle deflects.
    """
    low, high = (-1.0, 1.0) if over.variable == BRISTLE else (float(seen.min()), float(seen.max()))
    law, basis = _combined(over, (seen - low) / (high - low), over.bumps if bumps is None else bumps)
    weights = [
        EffectParameter(
            f"a{j}",
            over.amplitude,
            f"RMS {kind} of combination {j}",
            guess=0.0,
            nests=True,
        )
        for j in range(law.combinations)
    ]
    known = law.known(low, high, basis)
    memory = MEMORIES.get(over.variable)
    return Effect(
        id="learned_" + str(over).replace(", ", "_").replace(" ", "_"),
        kind=kind,
        title=f"learned {kind} over {over}",
        equation=equation_of(over, "sum_j a_j sum_k V_kj exp(-(s - c_k)²/(2 width²))"),
        law=law,
        parameters=(*weights, *((memory.parameter(remembers),) if memory else ()), *known),
        states=(memory.state,) if memory else (),
        dynamics=memory.dynamics if memory else None,
        needs=over.needs,
        channels=over.channels,
        source="thesis Eqs. 6-4 to 6-6 with fixed centres",
        pattern=f"any function of {over}",
    )


def is_learned(effect: Effect) -> bool:
    """Whether the effect is a learned effort or flow."""
    return isinstance(effect.law, Bumps)


def with_learned_effort(
    base: Refit, fitted: Path, port: str, over: Over
) -> tuple[Model, list[dict[str, float]]]:
    """The model of ``base`` with a learned effort (or flow) at ``port``, on what the path ``fitted`` covers,
    and where its fit starts: from zero effort, with every time constant that it may have."""
    where = base.model.plant.port(port)
    remembers = fitted.memory(port, over.variable)
    effect = learned_effort(where.kind, over, fitted.covered(port, over), remembers=remembers)
    model = base.model.plus(effect, port)
    name = model.terms[-1].name
    others = [{f"{name}.{p.name}": v} for p in effect.parameters for v in p.starts_at(where)]
    return model, [{**base.values, **one} for one in ({}, *others)]


def _combined(over: Over, seen: Array, bumps: int) -> tuple[Bumps, Array]:
    """The law of those combinations (bumps, n) that ``seen`` (n,), from 0 to 1 over the range, shows: each of
    mean square one there."""
    places = seen * (bumps - 1)
    shapes = np.exp(-((places[:, None] - np.arange(bumps)) ** 2) / 2)
    spread, components = np.linalg.eigh(shapes.T @ shapes / len(seen))
    shown = spread > FAINT * spread[-1]
    basis = components[:, shown] / np.sqrt(spread[shown])
    return Bumps(over, bumps, basis.shape[1]), basis
