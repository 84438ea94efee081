"""Starts of a load behind a spring or a play: a part of the inertia that the model without it has found.

Slow motion shows the sum of both inertias alone, and the model without the load has found that as the
machine's. With no load to begin with, a descent goes along a valley in which the sum stays: it is long, and
may end at a small load. So the load also begins in the midst of it, with half of the sum.

A load behind a play has a rough valley besides: each knock comes a little earlier or later. What the records
tell well is about the product of load and play, so a descent hardly leaves the load that it began with. It
therefore begins with several, each with its contact closed: the play is no wider than the error that the
model without it leaves, and the contact as stiff as the sampling resolves. From there the play opens.

The inertia at a port is 1 over the change of its acceleration by an effort there. Of the plant's parameters,
the one that makes up most of it gives the load away.

Source: Spong (1987), ASME J. Dyn. Syst. Meas. Control 109(4), 310-319 (a machine and its load as two bodies).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.effects.dimension import FREQUENCY
from hybridid.model import Model
from hybridid.trace.candidates import Candidate, each_once
from hybridid.trace.horizons.split import Split
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refitted import Refit
from hybridid.validation.port_efforts import PROBE

Array = NDArray[np.float64]
PROBES = 50
"""Samples at which the inertia is computed; their median counts."""
NUDGE = 1e-4
"""Share of its value by which a parameter is changed, to see how much of the inertia it makes up."""
MOST = 0.6
"""Share of the inertia that a parameter makes up at least, to give a part of it away."""
BEHIND_PLAY = (1 / 6, 1 / 3, 1 / 2)
"""Shares of the inertia with which a load behind a play begins."""
FASTEST = 0.2
"""Highest natural frequency that samples resolve, over that of the sampling: a fifth of a period a sample."""


@dataclass(frozen=True)
class Giver:
    """The parameter of the plant that makes up most of the inertia at a port: its ``name`` and ``value``, the
    ``share`` of the inertia that it makes up, and the ``whole`` inertia."""

    name: str
    value: float
    share: float
    whole: float

    def without(self, part: float) -> float:
        """Its value where it has given this part of the inertia away."""
        return self.value - self.value_of(part * self.whole)

    def value_of(self, inertia: float) -> float:
        """What makes up so much ``inertia``."""
        return self.value * inertia / (self.share * self.whole)


def with_half_the_inertia(
    candidate: Candidate, starts: Sequence[dict[str, float]], base: Refit, split: Split
) -> list[dict[str, float]]:
    """``starts`` with half of the inertia at the port as that of the load; none where the effect has no load,
    or no parameter of the plant is that inertia."""
    load = sought_by(candidate, "load")
    giver = giver_of(candidate.port, base, split) if load and starts else None
    return each_once([{**start, **_given(giver, 0.5, load)} for start in starts]) if giver else []


def with_closed_contact(
    candidate: Candidate, model: Model, base: Refit, split: Split
) -> list[dict[str, float]]:
    """Starts of a load behind a play in the augmented ``model``: with each of ``BEHIND_PLAY`` of the inertia
    and the contact closed. None where the effect has no play, no output shows the port's position or no
    parameter of the plant is that inertia."""
    load, play = sought_by(candidate, "load"), narrow_play(candidate, model, base)
    giver = giver_of(candidate.port, base, split) if load and play else None
    if giver is None:
        return []
    frequencies = [p.name for p in candidate.effect.parameters if p.dimension == FREQUENCY]
    stiff = dict.fromkeys((f"{candidate.name}.{name}" for name in frequencies), FASTEST / split.records[0].dt)
    start = {**candidate.starts(model, base.values)[0], **play, **_within(stiff, model)}
    return [{**start, **_given(giver, part, load)} for part in BEHIND_PLAY]


def narrow_play(candidate: Candidate, model: Model, base: Refit) -> dict[str, float]:
    """The play of the effect, by its name in the augmented ``model``, as wide as the error that ``base``
    leaves at the port; empty if the effect has no play, or no output shows the port's position."""
    play, seen = sought_by(candidate, "play"), _least_error(candidate.port, base)
    return _within({play: seen}, model) if play and seen is not None else {}


def _within(values: Mapping[str, float], model: Model) -> dict[str, float]:
    """``values``, by name, within the bounds of the parameters of ``model``."""
    bounds = {p.name: (p.lower, p.upper) for p in model.parameters}
    return {name: min(max(value, bounds[name][0]), bounds[name][1]) for name, value in values.items()}


def sought_by(candidate: Candidate, what: str) -> str:
    """The parameter, by its qualified name, of which starts are ``sought`` as ``what``; empty if none is."""
    names = (f"{candidate.name}.{p.name}" for p in candidate.effect.parameters if p.sought == what)
    return next(names, "")


def _given(giver: Giver, part: float, load: str) -> dict[str, float]:
    """The values where ``giver`` has given ``part`` of the inertia to the parameter ``load``."""
    return {giver.name: giver.without(part), load: part * giver.whole}


def _least_error(port: str, base: Refit) -> float | None:
    """The least held-out RMSE of the outputs in the unit of the port's position; None if there is none."""
    unit = base.model.plant.port(port).position_unit
    errors = [e for e, one in zip(base.score.rmse, base.model.outputs, strict=True) if one.unit == unit]
    return float(min(errors)) if errors else None


def giver_of(port: str, base: Refit, split: Split) -> Giver | None:
    """The parameter that gives the load at ``port`` away; None if none makes up enough of the inertia, or its
    value without half of it is below its bound."""
    path = Path.of(base, split, split.fitted[:1])
    inertia = _inertia(base.model, port, path)
    whole = inertia(base.values)
    if not (np.isfinite(whole) and whole > 0):
        return None
    found = []
    own = {p.name for p in base.model.plant.parameters}
    for p in base.model.free:
        value = base.values[p.name]
        if p.name in own and value > 0:
            more = inertia({**base.values, p.name: (1 + NUDGE) * value})
            found.append((Giver(p.name, value, (more - whole) / (NUDGE * whole), whole), p.lower))
    if not found:
        return None
    most, lower = max(found, key=lambda one: one[0].share)
    return most if most.share >= MOST and most.without(0.5) >= lower else None


def _inertia(model: Model, port: str, path: Path) -> Callable[[Mapping[str, float]], float]:
    """The inertia at ``port`` along ``path``, as a function of the model's parameters by name: 1 over what
    an effort there takes from the acceleration; nan where the port is not accelerated by it."""
    probed = model.plus(PROBE, port)
    t, x, u, p = probed.f.sx_in()
    place = [one.name for one in model.equation_ports].index(port)
    velocity = probed.motions(t, x, u, p)[place, 1]
    acceleration = ca.jtimes(velocity, x, probed.f(t, x, u, p))
    effort = p[[one.name for one in probed.parameters].index(f"{port}.{PROBE.id}.unit")]
    by_effort = ca.Function("by_effort", [t, x, u, p], [ca.jacobian(acceleration, effort)])
    chosen = np.unique(np.linspace(0, len(path.time) - 1, PROBES).astype(int))

    def at(values: Mapping[str, float]) -> float:
        q = probed.values(values)
        found = [float(by_effort(path.time[k], path.states[k], path.inputs[k], q)) for k in chosen]
        taken = -float(np.median(found))
        return 1.0 / taken if taken > 0 else np.nan

    return at
