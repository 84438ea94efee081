"""Candidate terms for a regression: what each effect of the library gives along a motion that is known.

Shape parameters run over grids; an amplitude is a coefficient. The terms of effort are computed from the
library's own laws, with a sharp sign; effects with memory along the motion by ``memory``.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import SimpleNamespace

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from benchmarks.league.memory import STATES
from benchmarks.league.signals import Equation
from hybridid.declarations import Port
from hybridid.effects.effect import Effect, EffectParameter, Local
from hybridid.effects.library import EFFECTS
from hybridid.model import Model

Array = NDArray[np.float64]
POINTS = {1: 12, 2: 5}
"""Grid points of each shape parameter where an effect has one or two; where more, those with declared
starts get ``FEW`` and the others their guess."""
PLANTS_OWN = {
    "oscillator.linear_stiffness",
    "oscillator.viscous",
    "link.linear_stiffness",
    *(f"{end}_suspension.{what}" for end in ("front", "rear") for what in ("linear_stiffness", "viscous")),
    *(f"{end}_tyre.linear_stiffness" for end in ("front", "rear")),
}
"""Terms that a declared model has in its plant, with a free parameter (the eSEA's link has none)."""
FEW, MANY = 4, 40
SHARP = 1e-6
"""Smoothing of sign(v) over the port's velocity scale."""
DEGENERATE = 0.03
"""Share of a column that must be new beside the declared terms: below it the two are one."""


@dataclass(frozen=True)
class Term:
    """A candidate: an effect at a port, at one value of its shape."""

    effect: Effect
    port: str
    shape: tuple[tuple[str, float], ...]

    @property
    def name(self) -> str:
        return f"{self.port}.{self.effect.id}"


def terms(model: Model, eq: Equation, coarse: bool = False, memory: bool = True) -> Iterator[Term]:
    """Every effect of the library at every port where the regression can hold it, over the grid of its shape.

    ``coarse``: the library's guess and starts alone; ``memory``: also efforts with inner states.
    """
    present = {term.name for term in model.terms}
    for effect, port in itertools.product(EFFECTS, model.plant.ports):
        if not effect.admissible_at(port) or f"{port.name}.{effect.id}" in present:
            continue
        if effect.kind == "effort" and effect.states and not (memory and effect.id in STATES):
            continue
        if effect.needs:  # the regression knows the motion and no load
            continue
        if effect.kind == "effort" and port.name in eq.motion and _not_the_plants(effect, port.name, eq):
            yield from (Term(effect, port.name, shape) for shape in _shapes(effect, port, eq, coarse))
        elif effect.kind == "input" and _shows(effect, eq):
            grid = _input_grid(effect.id, eq.inputs[port.name])
            grid = grid[len(grid) // 2 :][:1] if coarse else grid
            yield from (Term(effect, port.name, (("value", float(x)),)) for x in grid)
        elif effect.id == "sensor_lag" and port.name == eq.output:
            yield Term(effect, port.name, ())


def _not_the_plants(effect: Effect, port: str, eq: Equation) -> bool:
    """Not a spring or damper beside the plant's own free one; an inertia only where the plant's is known."""
    own = f"{port}.{effect.id}" in PLANTS_OWN and not eq.scaled
    return not own and (effect.id != "added_inertia" or eq.scaled)


def _shows(effect: Effect, eq: Equation) -> bool:
    return effect.id != "input_gain" or eq.scaled


def columns(term: Term, eq: Equation, theta: Array, port: Port) -> Array:
    """What the term adds to the right-hand side of ``eq``, (N, m): one column an amplitude.

    ``theta`` (k,) is the fitted base, whose prediction stands for the input where the input itself, being
    the regressand, may not.
    """
    if term.effect.kind == "effort":
        made = _efforts(term, eq, port)
        return np.column_stack([eq.push(term.port, one) for one in made])
    predicted = eq.base @ theta
    if term.effect.kind == "output":
        return eq.rate(predicted)[:, None]
    return _of_input(term, eq, predicted)[:, None]


def _of_input(term: Term, eq: Equation, predicted: Array) -> Array:
    u, dt, value = eq.inputs[term.port], eq.dt, term.shape[0][1]
    rows = len(eq.y) // len(u)
    if term.effect.id == "input_delay":
        missing = u - np.interp(eq.time - value, eq.time, u)
    elif term.effect.id == "input_lag":
        kept = np.exp(-dt / value)
        missing = u - lfilter([1 - kept], [1, -kept], u, zi=[kept * u[0]])[0]
    elif term.effect.id == "input_gain":
        missing = -u
    elif term.effect.id == "input_nonlinearity":
        missing = u * np.abs(u)
    elif term.effect.id == "input_rate_limit":
        missing = u - _slewed(u, value * dt)
    else:
        signal = predicted[: len(u)] if rows == 1 and not eq.scaled else u
        clipped = np.clip(signal, -value, value)
        missing = signal - clipped if term.effect.id == "input_saturation" else clipped
    # a column enters where the input does: in the first equation, with the input's own weight there
    weight = float(eq.y[: len(u)] @ u / (u @ u)) if rows > 1 else 1.0
    made = np.zeros(len(eq.y))
    made[: len(u)] = weight * eq.smooth(missing)
    return made


def _slewed(u: Array, most: float) -> Array:
    """The input (n,) as it follows where it may change by ``most`` a sample."""
    found, last = np.empty_like(u), float(u[0])
    for k, wanted in enumerate(u.tolist()):
        last += min(max(wanted - last, -most), most)
        found[k] = last
    return found


def _input_grid(what: str, u: Array) -> Array:
    largest = float(np.abs(u).max())
    return {
        "input_delay": np.geomspace(5e-4, 0.02, 10),
        "input_lag": np.geomspace(5e-4, 0.05, 10),
        "input_gain": np.array([0.0]),
        "input_nonlinearity": np.array([0.0]),
        "input_rate_limit": largest / np.geomspace(0.005, 0.5, 10),
        "input_saturation": largest * np.linspace(0.3, 0.95, 10),
        "input_dead_zone": largest * np.geomspace(0.005, 0.3, 10),
    }[what]


def _shapes(
    effect: Effect, port: Port, eq: Equation, coarse: bool
) -> Iterator[tuple[tuple[str, float], ...]]:
    free = [p for p in effect.parameters if not p.nests and (not p.fixed or p.starts)]
    if coarse:
        grids = [(p.guess * p.scale_at(port), *p.starts_at(port)) for p in free]
        grids = [g if len(free) < 3 or p.starts else g[:1] for p, g in zip(free, grids, strict=True)]
    else:
        grids = [_grid(p, port, eq, len([q for q in free if not q.fixed])) for p in free]
    for values in itertools.product(*grids):
        yield tuple(zip((p.name for p in free), map(float, values), strict=True))


def _grid(p: EffectParameter, port: Port, eq: Equation, together: int) -> Array:
    known = np.array([p.guess * p.scale_at(port), *p.starts_at(port)])
    q = eq.motion[port.name][0]
    stroke = np.ptp(q)
    if p.fixed:
        return known
    if p.sought == "period":
        return np.geomspace(stroke / 50, 2 * stroke, MANY)
    if p.sought == "frequency":
        return np.geomspace(0.3, 0.5 * eq.cutoff, MANY if together == 1 else 14)
    if p.guess == 0:
        return np.append(q.min() + stroke * np.linspace(0, 1, POINTS[2]), 0.0)
    if p.name == "d":  # where a stop or the ground begins
        return np.linspace(0.3, 0.97, POINTS[1]) * np.abs(q).max()
    if together > 2 and not p.starts:
        return known[:1]
    lowest, highest = max(known.min() / 3, p.lower * p.scale_at(port)), known.max() * 3
    return np.geomspace(lowest, min(highest, p.upper * p.scale_at(port)), POINTS.get(together, FEW))


def _efforts(term: Term, eq: Equation, port: Port) -> list[Array]:
    q, v, a = eq.motion[term.port]
    shape = {p.name: p.guess * p.scale_at(port) for p in term.effect.parameters} | dict(term.shape)
    amplitudes = [p.name for p in term.effect.parameters if p.nests]
    z = np.empty((len(q), 0))
    if term.effect.states:
        z = STATES[term.effect.id](v, a, eq.dt, shape)
    function = _law(term.effect, SHARP * port.velocity_scale, len(q))
    made, moved = [], np.vstack([eq.time, q, v, a, z.T])
    for one in amplitudes:
        p = {**shape, **{name: float(name == one) for name in amplitudes}}
        values = np.array([p[q_.name] for q_ in term.effect.parameters])
        made.append(np.asarray(function(values, moved)).ravel())
    return made


@functools.cache
def _law(effect: Effect, epsilon: float, n: int) -> ca.Function:
    """(parameters (n_p,), motion (4 + n_z, n)) -> effort (1, n)."""
    p = ca.SX.sym("p", len(effect.parameters))
    moved = ca.SX.sym("moved", 4 + len(effect.states))
    named: Mapping[str, ca.SX] = {q.name: p[i] for i, q in enumerate(effect.parameters)}
    states = {s.name: moved[4 + i] for i, s in enumerate(effect.states)}
    local = Local(
        p=SimpleNamespace(**named),
        z=SimpleNamespace(**states),
        time=moved[0],
        epsilon=epsilon,
        position=moved[1],
        velocity=moved[2],
        acceleration=moved[3],
    )
    one = ca.Function(effect.id, [p, moved], [ca.SX(effect.law(local))])
    return one.map(effect.id, "serial", n, [0], [])
