"""``Model``: a plant plus effects at its ports, as flat CasADi functions.

``x' = f(t, x, u, p)`` and ``y = h(t, x, u, p)`` with x (n_x,), u (n_u,), y (n_y,) and
p (n_p,) in the order of ``states``, ``inputs``, ``outputs`` and ``parameters``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar, cast

import casadi as ca
import numpy as np

from hybridid.declarations import Need, Parameter, Port, Signal, State
from hybridid.effects.effect import Effect
from hybridid.model.assembly import assemble
from hybridid.model.groups import Groups, by_group, names_of, weights_of
from hybridid.model.term import Term
from hybridid.naming import unknown
from hybridid.plants.plant import Plant

T = TypeVar("T")


@dataclass(frozen=True)
class Model:
    """A plant and its terms. ``adjustments`` overrides declared guesses and bounds.

    ``channels`` are auxiliary channels of the records (a temperature, a supply voltage). The plant does not
    know them; its effects may see them. In u they follow the plant's inputs.

    ``by_record`` names parameters of the plant that are known, and differ from record to record (the gain of
    a controller, a load that is changed). Each record gives its own value, so they are no parameters of the
    model: in u they follow the channels.

    ``groups`` names parameters that a fit estimates once for each group of records, with the names of the
    groups: ``{"carriage.coulomb.f_c": ("cold", "warm")}``. The records give the weights (``model.groups``),
    which come last in u. A parameter of a term that is left out keeps its weights there.

    ``plus`` and ``without`` return new models. With its nesting parameters at zero, a term changes
    nothing, so ``model`` is a special case of ``model.plus(effect)``.

    Raises:
        ValueError: if a term occurs twice, its port does not exist, is of another kind, or does not know the
            load that the effect needs; if the effect sees a channel that the model lacks, two channels or
            inputs share a name, or ``by_record`` names no parameter of the plant.
    """

    plant: Plant
    terms: tuple[Term, ...] = ()
    adjustments: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    channels: tuple[Signal, ...] = ()
    by_record: tuple[str, ...] = ()
    groups: Groups = field(default_factory=dict)

    def __post_init__(self) -> None:
        names = [term.name for term in self.terms]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"effect {name} stands twice in the model")
        for term in self.terms:
            kind = self.plant.port(term.port).kind
            if kind != term.effect.kind:
                raise ValueError(
                    f"effect {term.effect.id} acts at {term.effect.kind} ports; {term.port} is of kind {kind}"
                )
            for one in map(self.plant.port, term.ports):
                if not term.effect.possible_at(one):
                    raise ValueError(
                        f"effect {term.effect.id} needs {_asked(term.effect)}; {one.name} {_lacks(one)}"
                    )
        self._check_channels()
        known = [p.name for p in self.plant.parameters]
        for name in self.by_record:
            if name not in known:
                raise ValueError(unknown("parameter of the plant, given by the records:", name, known))

    def _check_channels(self) -> None:
        names = [signal.name for signal in self.inputs]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"channel {name}: two inputs or channels of the model have that name")
        for term in self.terms:
            for name in term.effect.channels:
                if name not in names:
                    raise ValueError(unknown(f"channel that effect {term.name} sees", name, names))

    def __getstate__(self) -> dict[str, object]:
        """The declaration of the model only: the CasADi functions are built again after unpickling."""
        adjustments = dict(self.adjustments)
        return {
            "plant": self.plant, "terms": self.terms, "adjustments": adjustments, "channels": self.channels,
            "by_record": self.by_record, "groups": dict(self.groups),
        }  # fmt: skip

    def plus(self, effect: Effect, port: str | None = None) -> Model:
        """This model with ``effect`` added at ``port`` (default: the first where it is possible)."""
        where = port or first_port(self.plant, effect).name
        return replace(self, terms=(*self.terms, Term(effect, where)))

    def without(self, term_name: str) -> Model:
        """This model without the term ``name``.

        Raises:
            ValueError: if it has no such term.
        """
        kept = tuple(term for term in self.terms if term.name != term_name)
        if len(kept) == len(self.terms):
            raise ValueError(unknown("term", term_name, [term.name for term in self.terms]))
        return replace(self, terms=kept)

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Every constant under its qualified name, with the adjustments; the ports' epsilons come last."""
        own = [p for p in self.plant.parameters if p.name not in self.by_record]
        for term in self.terms:
            port = self.plant.port(term.port)
            own += [p.at(port).renamed(f"{term.name}.{p.name}") for p in term.effect.parameters]
        smooth = [
            _epsilon(port)
            for port in self.plant.ports
            if port.kind == "effort" and any(port.name in t.ports for t in self.terms)
        ]
        adjusted = tuple(self._adjusted(p) for p in (*own, *smooth))
        for p in adjusted[len(own) :]:
            if not p.guess > 0:
                raise ValueError(f"{p.name} is {p.guess:g} {p.unit}: a smoothing velocity must be positive")
        if not self.groups:
            return adjusted
        return tuple(
            self._adjusted(each) if p.name in self.groups else each
            for p in adjusted
            for each in by_group(p, self.groups)
        )

    def _adjusted(self, parameter: Parameter) -> Parameter:
        return _adjusted(parameter, self.adjustments.get(parameter.name, {}))

    def names_of(self, name: str) -> tuple[str, ...]:
        """The qualified names of the values that parameter ``name`` takes: its own, or one for each group."""
        return names_of(name, self.groups)

    @cached_property
    def states(self) -> tuple[State, ...]:
        """The plant's states, then each term's, under qualified names."""
        own = list(self.plant.states)
        for term in self.terms:
            port = self.plant.port(term.port)
            own += [s.at(port).of_term(term.name) for s in term.effect.states]
        return tuple(own)

    @property
    def inputs(self) -> tuple[Signal, ...]:
        """The plant's inputs, the channels and what each record gives, in the order of u (n_u,)."""
        return (*self.signals, *self.given)

    @property
    def signals(self) -> tuple[Signal, ...]:
        """The plant's inputs, then the channels: what runs in time, and what effects may see."""
        return (*self.plant.inputs, *self.channels)

    @property
    def given(self) -> tuple[Signal, ...]:
        """The parameters ``by_record``, then the weights of the ``groups``."""
        known = (p for p in self.plant.parameters if p.name in self.by_record)
        return (*(Signal(p.name, p.unit, p.meaning) for p in known), *weights_of(self.groups))

    @property
    def outputs(self) -> tuple[Signal, ...]:
        """The plant's outputs, in the order of y (n_y,)."""
        return self.plant.outputs

    @property
    def equation_ports(self) -> tuple[Port, ...]:
        """The plant's ports where an effort or a flow acts, in the order of ``motions``."""
        return self.plant.equation_ports

    @property
    def free(self) -> tuple[Parameter, ...]:
        """The parameters that a fit estimates."""
        return tuple(p for p in self.parameters if not p.fixed)

    @property
    def smooths(self) -> bool:
        """Whether a sign(v) is smoothed over some epsilon: whether an effect stands at an effort port."""
        return any(self.plant.port(term.port).kind == "effort" for term in self.terms)

    def values(self, known: Mapping[str, float] | None = None) -> np.ndarray:
        """Parameter vector (n_p,): guesses, overwritten by ``known``.

        Raises:
            ValueError: if ``known`` names a parameter that the model lacks.
        """
        given = dict(known or {})
        vector = np.array([given.pop(p.name, p.guess) for p in self.parameters], dtype=float)
        if given:
            raise ValueError(unknown("parameter", next(iter(given)), [p.name for p in self.parameters]))
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
    def at_once(self) -> frozenset[str]:
        """Outputs that depend on an input at once, as a measured force or acceleration may."""
        t, x, u, p = self.h.sx_in()
        known = u[: len(self.plant.inputs)]
        depends = ca.which_depends(self.h(t, x, u, p), known, 1, True) if known.numel() else []
        return frozenset(s.name for s, does in zip(self.plant.outputs, depends, strict=False) if does)

    @cached_property
    def by_state(self) -> ca.Function:
        """``df/dx``, dense, ``(t, x, u, p) -> (n_x, n_x)``."""
        given = self.f.sx_in()
        return ca.Function("A", given, [ca.densify(ca.jacobian(self.f(*given), given[1]))])

    def kept(self, key: Hashable, make: Callable[[], T]) -> T:
        """What ``make`` derives from the functions above, made once and kept as long as the model lives."""
        if key not in self._derived:
            self._derived[key] = make()
        return cast(T, self._derived[key])

    @cached_property
    def _derived(self) -> dict[Hashable, Any]:
        return {}

    @property
    def effort_places(self) -> tuple[tuple[Term, str], ...]:
        """Each term that is an effort or a flow, with each of its ports, in the order of ``efforts``."""
        return tuple((term, port) for term in self.terms if term.effect.in_equations for port in term.ports)

    @cached_property
    def efforts(self) -> ca.Function:
        """Effort or flow of each of ``effort_places``, ``(t, x, u, p) -> (n_places,)``, in port units."""
        return self._functions[2]

    @cached_property
    def motions(self) -> ca.Function:
        """Position and velocity of each of ``equation_ports``, ``(t, x, u, p) -> (n_ports, 2)``."""
        return self._functions[3]

    @cached_property
    def _functions(self) -> tuple[ca.Function, ca.Function, ca.Function, ca.Function]:
        return assemble(self.plant, self.terms, self.states, self.inputs, self.parameters, self.groups)


def first_port(plant: Plant, effect: Effect) -> Port:
    """The plant's first port of the effect's kind that has what the effect needs.

    Raises:
        ValueError: if it has none.
    """
    for port in plant.ports:
        if effect.possible_at(port):
            return port
    needs = f", which needs {_asked(effect)}" if effect.needs else ""
    raise ValueError(f"plant {plant.name} has no {effect.kind} port for effect {effect.id}{needs}")


_NEEDS: Mapping[Need, str] = {
    "load": "a port that knows its load",
    "drive": "a port that knows its drive",
    "both_sides": "a port that knows its drive and its load",
    "level": "a port that knows what sets the level of its friction",
}


def _asked(effect: Effect) -> str:
    return " and ".join(_NEEDS[need] for need in effect.needs)


def _lacks(port: Port) -> str:
    known = ", ".join(sorted(port.knows)).replace("_", " ")
    return f"knows {known} only" if known else f"has no load ({port.no_load or 'none is declared'})"


def _epsilon(port: Port) -> Parameter:
    name = f"{port.name}.epsilon"
    unit = f"{port.position_unit}/s"
    said = "smoothing velocity of sign(v)"
    return Parameter(name, unit, port.epsilon, lower=0.0, fixed=True, meaning=said, smooths=1)


def _adjusted(parameter: Parameter, changes: Mapping[str, float]) -> Parameter:
    """The declared parameter with a user's guess, bounds or fixed value; bounds make a fixed one free. The
    guess is its scale, unless one of nothing was declared: then a small value is no scale."""
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
    scale = parameter.scale if guess == 0 or parameter.guess == 0 else abs(guess)
    known = parameter.fixed and "lower" not in changes and "upper" not in changes
    return replace(parameter, guess=guess, lower=lower, upper=upper, scale=scale, fixed=known)
