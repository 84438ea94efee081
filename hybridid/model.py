"""``Model``: a plant plus effects at its ports, as flat CasADi functions.

``x' = f(t, x, u, p)`` and ``y = h(t, x, u, p)`` with x (n_x,), u (n_u,), y (n_y,) and
p (n_p,) in the order of ``states``, ``inputs``, ``outputs`` and ``parameters``.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import SimpleNamespace

import casadi as ca
import numpy as np

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.effects.effect import Effect, Local
from hybridid.effects.library import effect_named
from hybridid.plants.plant import Motion, Plant

ADJUSTABLE = ("guess", "lower", "upper", "fixed")


@dataclass(frozen=True)
class Term:
    """An effect at a port."""

    effect: Effect
    port: str

    @property
    def name(self) -> str:
        return f"{self.port}.{self.effect.id}"


@dataclass(frozen=True)
class Model:
    """A plant and its terms. ``adjustments`` overrides declared guesses and bounds.

    ``plus`` and ``without`` return new models; with its nesting parameters at zero a
    term changes nothing, so ``model`` lies inside ``model.plus(effect)``.

    Raises:
        ValueError: if a term stands twice, or at no port or one of another kind.
    """

    plant: Plant
    terms: tuple[Term, ...] = ()
    adjustments: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        names = [term.name for term in self.terms]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"effect {name} stands twice in the model")
        for term in self.terms:
            kind = self.plant.port(term.port).kind
            if kind != term.effect.kind:
                raise ValueError(
                    f"effect {term.effect.id} acts at {term.effect.kind} ports; {term.port} is {kind}"
                )

    def __getstate__(self) -> dict[str, object]:
        """Only what declares the model: built CasADi functions do not travel."""
        return {"plant": self.plant, "terms": self.terms, "adjustments": dict(self.adjustments)}

    def plus(self, effect: Effect, port: str | None = None) -> Model:
        """This model with ``effect`` added at ``port`` (default: the first of its kind)."""
        where = port or first_port(self.plant, effect).name
        return replace(self, terms=(*self.terms, Term(effect, where)))

    def without(self, term_name: str) -> Model:
        """This model less one term.

        Raises:
            ValueError: if it has no such term.
        """
        kept = tuple(term for term in self.terms if term.name != term_name)
        if len(kept) == len(self.terms):
            raise ValueError(_unknown("term", term_name, [term.name for term in self.terms]))
        return replace(self, terms=kept)

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Every constant under its qualified name, adjusted; the last are the ports' epsilons."""
        own = list(self.plant.parameters)
        for term in self.terms:
            port = self.plant.port(term.port)
            own += [p.at(port).renamed(f"{term.name}.{p.name}") for p in term.effect.parameters]
        smooth = [
            _epsilon(port) for port in self.effort_ports if any(t.port == port.name for t in self.terms)
        ]
        adjusted = tuple(_adjusted(p, self.adjustments.get(p.name, {})) for p in (*own, *smooth))
        for p in adjusted[len(own) :]:
            if not p.guess > 0:
                raise ValueError(f"{p.name} is {p.guess:g} {p.unit}: a smoothing velocity must be positive")
        return adjusted

    @cached_property
    def states(self) -> tuple[State, ...]:
        """The plant's states, then each term's, under qualified names."""
        own = list(self.plant.states)
        for term in self.terms:
            port = self.plant.port(term.port)
            own += [s.at(port).renamed(f"{term.name}.{s.name}") for s in term.effect.states]
        return tuple(own)

    @property
    def inputs(self) -> tuple[Signal, ...]:
        return self.plant.inputs

    @property
    def outputs(self) -> tuple[Signal, ...]:
        return self.plant.outputs

    @property
    def effort_ports(self) -> tuple[Port, ...]:
        return tuple(port for port in self.plant.ports if port.kind == "effort")

    @property
    def free(self) -> tuple[Parameter, ...]:
        """The parameters that a fit estimates."""
        return tuple(p for p in self.parameters if not p.fixed)

    def values(self, known: Mapping[str, float] | None = None) -> np.ndarray:
        """Parameter vector (n_p,): guesses, overwritten by ``known``.

        Raises:
            ValueError: if ``known`` names a parameter that the model lacks.
        """
        given = dict(known or {})
        vector = np.array([given.pop(p.name, p.guess) for p in self.parameters], dtype=float)
        if given:
            raise ValueError(_unknown("parameter", next(iter(given)), [p.name for p in self.parameters]))
        return vector

    @cached_property
    def f(self) -> ca.Function:
        """``x' = f(t, x, u, p)``."""
        return self._functions[0]

    @cached_property
    def h(self) -> ca.Function:
        """``y = h(t, x, u, p)``."""
        return self._functions[1]

    @cached_property
    def efforts(self) -> ca.Function:
        """Effort of each term at an effort port, ``(t, x, u, p) -> (n_terms,)``, in port units."""
        return self._functions[2]

    @cached_property
    def motions(self) -> ca.Function:
        """Position and velocity of each effort port, ``(t, x, u, p) -> (n_ports, 2)``."""
        return self._functions[3]

    @cached_property
    def _functions(self) -> tuple[ca.Function, ca.Function, ca.Function, ca.Function]:
        return _assemble(self)


def compose(
    plant: Plant,
    effects: Iterable[str | Effect] = (),
    adjustments: Mapping[str, Mapping[str, float]] | None = None,
) -> Model:
    """A model from names: ``"viscous"``, ``"viscous@carriage"``, ``"module:NAME@port"``.

    Raises:
        ValueError: if an effect or port is unknown, or an adjustment names no parameter
            of the model or gives something else than guess, lower, upper, fixed.
    """
    model = Model(plant, adjustments=dict(adjustments or {}))
    for entry in effects:
        if isinstance(entry, Effect):
            model = model.plus(entry)
            continue
        name, _, port = entry.partition("@")
        model = model.plus(effect_named(name), port or None)
    known = [p.name for p in model.parameters]
    for name, changes in model.adjustments.items():
        if name not in known:
            raise ValueError(_unknown("parameter", name, known))
        for key in changes:
            if key not in ADJUSTABLE:
                raise ValueError(_unknown(f"setting of parameter {name}", key, ADJUSTABLE))
    return model


def first_port(plant: Plant, effect: Effect) -> Port:
    """The plant's first port of the effect's kind.

    Raises:
        ValueError: if it has none.
    """
    for port in plant.ports:
        if port.kind == effect.kind:
            return port
    raise ValueError(f"plant {plant.name} has no {effect.kind} port for effect {effect.id}")


def _unknown(what: str, name: str, known: Sequence[str]) -> str:
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return f"unknown {what} {name!r}: {hint}known: {', '.join(known)}"


def _epsilon(port: Port) -> Parameter:
    name = f"{port.name}.epsilon"
    unit = f"{port.position_unit}/s"
    return Parameter(name, unit, port.epsilon, lower=0.0, fixed=True, meaning="smoothing velocity of sign(v)")


def _adjusted(parameter: Parameter, changes: Mapping[str, float]) -> Parameter:
    """The declared parameter with a user's guess, bounds or fixed value; bounds free a known one."""
    changes = {key: float(value) for key, value in changes.items() if value is not None}
    if not changes:
        return parameter
    if "fixed" in changes:
        return parameter.fixed_at(changes["fixed"])
    lower, upper = changes.get("lower", parameter.lower), changes.get("upper", parameter.upper)
    if lower == upper:
        return parameter.fixed_at(lower)
    guess = changes.get("guess")
    if guess is None:
        guess = min(max(parameter.guess, lower), upper)
        if guess in (lower, upper) and math.isfinite(upper - lower):
            guess = 0.5 * (lower + upper)
    scale = parameter.scale if guess == 0 else abs(guess)
    known = parameter.fixed and "lower" not in changes and "upper" not in changes
    return replace(parameter, guess=guess, lower=lower, upper=upper, scale=scale, fixed=known)


def _assemble(model: Model) -> tuple[ca.Function, ca.Function, ca.Function, ca.Function]:
    t = ca.SX.sym("t")
    x, x_by = _symbols([s.name for s in model.states])
    u, u_by = _symbols([s.name for s in model.inputs])
    p, p_by = _symbols([q.name for q in model.parameters])
    plant_p = SimpleNamespace(**{q.name: p_by[q.name] for q in model.plant.parameters})
    plant_x = SimpleNamespace(**{s.name: x_by[s.name] for s in model.plant.states})
    local = _Locals(model, t, x_by, p_by)

    plant_u, input_rates = local.through("input", u_by)
    motion = model.plant.motion(plant_x, plant_u, plant_p)
    efforts, effort_rates, rates = _resolve_acceleration(model, local, motion, plant_x, plant_u, plant_p)
    plain = {
        s.name: v for s, v in zip(model.outputs, _outputs(model, plant_x, plant_u, plant_p), strict=True)
    }
    measured, output_rates = local.through("output", plain)

    term_rates = {**input_rates, **effort_rates, **output_rates}
    x_dot = ca.vertcat(*[rates[s.name] if s.name in rates else term_rates[s.name] for s in model.states])
    y = ca.vertcat(*[getattr(measured, s.name) for s in model.outputs])
    moved = ca.vertcat(
        *[ca.horzcat(motion[q.name].position, motion[q.name].velocity) for q in model.effort_ports]
    )
    args, names = [t, x, u, p], ["t", "x", "u", "p"]
    return (
        ca.Function("f", args, [x_dot], names, ["x_dot"], {"cse": True}),
        ca.Function("h", args, [y], names, ["y"], {"cse": True}),
        ca.Function("efforts", args, [ca.vertcat(*efforts.values())], names, ["effort"]),
        ca.Function("motions", args, [moved], names, ["motion"]),
    )


def _symbols(names: Sequence[str]) -> tuple[ca.SX, dict[str, ca.SX]]:
    symbols = [ca.SX.sym(name) for name in names]
    return ca.vertcat(*symbols), dict(zip(names, symbols, strict=True))


def _outputs(model: Model, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace) -> list[ca.SX]:
    given = model.plant.output(x, u, p)
    return [given[s.name] for s in model.outputs]


@dataclass(frozen=True)
class _Locals:
    """Gives each term what it sees, and sums what the terms at a port do."""

    model: Model
    t: ca.SX
    x: Mapping[str, ca.SX]
    p: Mapping[str, ca.SX]

    def see(self, term: Term, **seen: ca.SX) -> Local:
        p = SimpleNamespace(**{q.name: self.p[f"{term.name}.{q.name}"] for q in term.effect.parameters})
        z = SimpleNamespace(**{s.name: self.x[f"{term.name}.{s.name}"] for s in term.effect.states})
        return Local(p=p, z=z, time=self.t, **seen)

    def rates(self, term: Term, local: Local) -> dict[str, ca.SX]:
        if term.effect.dynamics is None:
            return {}
        return {f"{term.name}.{name}": rate for name, rate in term.effect.dynamics(local).items()}

    def through(self, kind: str, signals: Mapping[str, ca.SX]) -> tuple[SimpleNamespace, dict[str, ca.SX]]:
        """Signals after the terms on their path, and the rates of those terms' states."""
        passed, rates = dict(signals), {}
        for term in self.model.terms:
            if term.effect.kind == kind:
                local = self.see(term, signal=passed[term.port])
                passed[term.port] = passed[term.port] + term.effect.law(local)
                rates.update(self.rates(term, local))
        return SimpleNamespace(**passed), rates


def _resolve_acceleration(
    model: Model,
    local: _Locals,
    motion: Mapping[str, Motion],
    x: SimpleNamespace,
    u: SimpleNamespace,
    p: SimpleNamespace,
) -> tuple[dict[str, ca.SX], dict[str, ca.SX], Mapping[str, ca.SX]]:
    """Efforts, term rates and plant rates, with port accelerations eliminated.

    An effect may use the port's acceleration a (added inertia). The equations of motion
    are affine in the efforts and so in a: ``a = g(a)`` is solved by one exact Newton step.

    Raises:
        ValueError: if an effect uses the acceleration otherwise than linearly.
    """
    ports = model.effort_ports
    a = ca.vertcat(*[ca.SX.sym(f"a_{port.name}") for port in ports])
    efforts: dict[str, ca.SX] = {}
    term_rates: dict[str, ca.SX] = {}
    total = {port.name: ca.SX(0) for port in ports}
    for term in model.terms:
        if term.effect.kind != "effort":
            continue
        at, index = motion[term.port], [port.name for port in ports].index(term.port)
        epsilon = local.p[f"{term.port}.epsilon"]
        seen = local.see(
            term, epsilon=epsilon, position=at.position, velocity=at.velocity, acceleration=a[index]
        )
        efforts[term.name] = term.effect.law(seen)
        term_rates.update(local.rates(term, seen))
        total[term.port] += efforts[term.name]
    rates = model.plant.derivative(x, u, p, total)
    used = ca.vertcat(*efforts.values(), *term_rates.values())
    if not ports or not ca.depends_on(used, a):
        return efforts, term_rates, rates
    names = [s.name for s in model.plant.states]
    state = ca.vertcat(*[getattr(x, name) for name in names])
    velocity = ca.vertcat(*[motion[port.name].velocity for port in ports])
    gap = a - ca.jtimes(velocity, state, ca.vertcat(*[rates[name] for name in names]))
    if not ca.is_linear(gap, a):
        bent = [name for name, value in efforts.items() if not ca.is_linear(ca.SX(value), a)]
        raise ValueError(f"{', '.join(bent) or model.plant.name}: the acceleration must enter linearly")
    zero = ca.substitute(gap, a, ca.SX.zeros(a.shape))
    solved = -ca.solve(ca.jacobian(gap, a), zero)
    insert = lambda value: ca.substitute(ca.SX(value), a, solved)  # noqa: E731
    return (
        {name: insert(value) for name, value in efforts.items()},
        {name: insert(value) for name, value in term_rates.items()},
        {name: insert(value) for name, value in rates.items()},
    )
