"""``Path``: the way of a fitted model through some horizons, as its ports see it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from hybridid.effects.dimension import ONE
from hybridid.effects.effect import Effect, EffectParameter
from hybridid.effects.over import BRISTLE, RECENT, RECENT_LOAD, Over, factor_of
from hybridid.effects.variable import Variable
from hybridid.model import Model
from hybridid.plants.plant import TOGETHER, Plant
from hybridid.simulation.over_arrays import over_arrays
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refitted import Refit

Array = NDArray[np.float64]
LAGGED: Mapping[Variable, Variable] = {RECENT: "velocity", RECENT_LOAD: "load"}
"""Variables that are a lag of another one's modulus."""
AT_ONCE = 2**12
"""Samples of a path that are evaluated at once: so many stay in the processor's cache."""


LOAD = Effect(
    id="probe_of_load",
    kind="effort",
    title="drive minus load",
    equation="F = unit (drive - load)",
    law=lambda at: at.p.unit * (at.drive - at.load),
    parameters=(EffectParameter("unit", ONE, "one", guess=1.0, fixed=True, nests=True),),
    source="this module",
    pattern="none: it only shows what a port carries",
    needs=("load",),
)


@dataclass(frozen=True)
class Path:
    """A model's simulated path through some horizons: times (n,), states (n, n_x), inputs (n, n_u).

    ``p`` (n_p,) are the model's parameters.
    """

    model: Model
    p: Array
    time: Array
    states: Array
    inputs: Array

    @classmethod
    def of(cls, base: Refit, split: Split, horizons: Sequence[int]) -> Path:
        """The path of ``base`` through the numbered ``horizons`` of ``split``."""
        p = base.model.values(base.values)
        problem = base.problem(split).on(horizons)
        used = problem.windows.used
        states = problem.shooter(base.x0[list(horizons)], p).states
        return cls(base.model, p, problem.windows.time[used], states[used], problem.windows.inputs[used])

    def memory(self, port: str, variable: Variable) -> float:
        """The guess of a variable's memory: a tenth of the path's duration in s, or of its range."""
        seen = self.motion(port, "position") if variable == BRISTLE else self.time
        return float(np.ptp(seen)) / 10

    def motion(self, port: str, variable: Variable) -> Array:
        """A variable of the motion at ``port``, (n,), or of what it carries."""
        if variable == "time":
            return self.time
        if variable in LAGGED:
            share = min(1.0, float(np.median(np.diff(self.time))) / self.memory(port, variable))
            return np.asarray(
                lfilter([share], [1.0, share - 1.0], np.abs(self.motion(port, LAGGED[variable])))
            )
        if variable == BRISTLE:
            return _deflection(self.motion(port, "position"), self.memory(port, BRISTLE))
        if variable == "load":
            return self._load(port)
        ports = [q.name for q in self.model.equation_ports]
        positions, velocities = self._along(self.model, "motions", self.p).reshape(2, len(ports), -1)
        moved = velocities if variable == "velocity" else positions  # a level is a position
        return np.asarray(moved[ports.index(port)])

    def place(self, port: str) -> Array:
        """Position or level at a port, (n,), or the signal of an output port; of several, of the first."""
        first = port.split(TOGETHER)[0]
        outputs = [signal.name for signal in self.model.outputs]
        if first in outputs:
            return self._along(self.model, "h", self.p)[outputs.index(first)]
        return self.motion(first, "position")

    def seen(self, port: str, over: Over) -> Array:
        """The variable of a learned effort over ``over`` at ``port``, (n,); an input as it was recorded."""
        if over.signal is None:
            return self.motion(port, over.variable)
        return self.inputs[:, [s.name for s in self.model.inputs].index(over.signal.name)]

    def covered(self, port: str, over: Over) -> Array:
        """Values that the variable takes, (m,); of a recent load also those with a lag much shorter than the
        guess, up to the load itself: a learned effort must know its range before its lag is fitted."""
        seen = self.seen(port, over)
        if over.variable != RECENT_LOAD:
            return seen
        return np.concatenate([seen, np.abs(self.motion(port, "load"))])

    def factor(self, port: str, over: Over) -> Array:
        """The factor of a learned effort over ``over`` at ``port``, (n,)."""
        if not over.factor:
            return np.ones(len(self.time))
        probe = replace(
            LOAD, id="probe_of_factor", needs=over.needs, law=lambda at: at.p.unit * factor_of(over, at)
        )
        return self._probed(probe, port)

    def shows(self, port: str, over: Over) -> bool:
        """Whether ``port`` knows what a learned effort over ``over`` needs, and all of it changes along the
        path; a port may have no velocity. An input that is the load itself says nothing beside it."""
        plant = self.model.plant
        if not plant.port(port).knows.issuperset(over.needs):
            return False
        if over.signal is not None and is_load(plant, port, over.signal.name):
            return False
        moves = over.factor or over.variable == BRISTLE
        needed = (over, Over("velocity")) if moves else (over,)
        return all(np.ptp(self.seen(port, one)) > 0 for one in needed)

    def effort(self, model: Model, values: Mapping[str, float], port: str) -> Array:
        """Sum of the efforts of ``model``'s terms at ``port`` along this path, (n,)."""
        return np.asarray(self.efforts(model, values, port).sum(axis=0))

    def efforts(self, model: Model, values: Mapping[str, float], port: str) -> Array:
        """The effort of each of ``model``'s terms at ``port`` along this path, (terms, n)."""
        rows = [k for k, (_, where) in enumerate(model.effort_places) if where == port]
        if not rows:
            return np.zeros((0, len(self.time)))
        return self._along(model, "efforts", model.values(values))[rows]

    def effort_of(self, name: str, port: str) -> Array:
        """The effort of the model's own term ``name`` at ``port`` along this path, (n,)."""
        places = [(term.name, where) for term, where in self.model.effort_places]
        return self._along(self.model, "efforts", self.p)[places.index((name, port))]

    def _load(self, port: str) -> Array:
        """What the two sides of ``port`` press against each other, drive minus load, (n,)."""
        return self._probed(LOAD, port)

    def _probed(self, probe: Effect, port: str) -> Array:
        """What a probe shows at ``port``, (n,)."""
        probed = self.model.plus(replace(probe, kind=self.model.plant.port(port).kind), port)
        p = probed.values(dict(zip(self._names, self.p, strict=True)))
        return np.asarray(self._along(probed, "efforts", p)[-1])

    @property
    def _names(self) -> list[str]:
        return [p.name for p in self.model.parameters]

    def _along(self, model: Model, name: str, p: Array) -> Array:
        """The function ``name`` (t, x, u, p) of ``model`` at every sample: its entries, column after column,
        (entries, n)."""
        function = getattr(model, name)
        run = model.kept(("along", name), lambda: over_arrays(_dense(function)))
        rows = np.empty((function.numel_out(), len(self.time)))
        for start in range(0, len(self.time), AT_ONCE):
            part = slice(start, start + AT_ONCE)
            t, x, u = (a[part].T.copy() for a in (self.time, self.states, self.inputs))
            (entries,) = run([[t], list(x), list(u), list(p)])
            for row, entry in zip(rows, entries, strict=True):
                row[part] = entry
        return rows


def _dense(function: ca.Function) -> ca.Function:
    """``function`` with every entry of its result, also those that are always zero."""
    given = function.sx_in()
    return ca.Function(function.name(), given, [ca.densify(function(*given))], {"cse": True})


def is_load(plant: Plant, port: str, name: str) -> bool:
    """Whether what ``port`` carries is the input ``name`` alone, times a constant, plus a constant."""
    x, u, p = (
        SimpleNamespace(**{one.name: ca.SX.sym(one.name) for one in declared})
        for declared in (plant.states, plant.inputs, plant.parameters)
    )
    if not hasattr(u, name) or "load" not in plant.port(port).knows:
        return False
    at, given = plant.loads(x, u, p)[port], getattr(u, name)
    carried = ca.SX(at.drive - at.load)
    others = ca.vertcat(*vars(x).values(), *(one for one in vars(u).values() if one is not given))
    alone = ca.depends_on(carried, given) and not ca.depends_on(carried, others)
    return bool(alone and ca.is_linear(carried, given))


def _deflection(position: Array, length: float) -> Array:
    """Deflection of a bristle over its largest, (n,), along ``position`` (n,), exact for monotone steps."""
    steps = np.diff(position, prepend=position[0])
    kept, toward = np.exp(-np.abs(steps) / length), np.sign(steps)
    found = np.zeros(len(position))
    for k in range(1, len(found)):
        found[k] = toward[k] + (found[k - 1] - toward[k]) * kept[k]
    return found
