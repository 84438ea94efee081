"""From a plant and its terms to flat CasADi functions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from hybridid.blame import Named, blamed_on
from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.effects.effect import LOAD_WIDTH, Local
from hybridid.model.asked import (
    Symbols,
    check_numbers,
    dynamics_of,
    law_of,
    loads_of,
    motion_of,
    outputs_of,
    rates_of,
)
from hybridid.model.groups import Groups, weighted
from hybridid.model.term import Term
from hybridid.plants.plant import Load, Motion, Plant


def assemble(
    plant: Plant,
    terms: Sequence[Term],
    states: Sequence[State],
    inputs: Sequence[Signal],
    parameters: Sequence[Parameter],
    groups: Groups,
) -> tuple[ca.Function, ca.Function, ca.Function, ca.Function]:
    """A model's ``f``, ``h``, ``efforts`` and ``motions``, as functions of (t, x, u, p).

    ``states`` (n_x) and ``parameters`` (n_p) are those of the plant and of the terms, under their
    qualified names, in the order of x and p. ``inputs`` (n_u) are those of the plant, the channels,
    the plant's parameters that each record gives, and the weights of the ``groups``.

    Raises:
        OwnCodeError: if code of the plant or of an effect fails, or gives something else than equations.
        ValueError: if an effect is not linear in the acceleration.
    """
    t = ca.SX.sym("t")
    x, x_by = _symbols([s.name for s in states])
    u, u_by = _symbols([s.name for s in inputs])
    p, p_by = _symbols([q.name for q in parameters])
    p_by |= weighted(groups, u_by, p_by)
    p_by |= {q.name: u_by.pop(q.name) for q in plant.parameters if q.name not in p_by}
    plant_p = Named("parameter", {q.name: p_by[q.name] for q in plant.parameters})
    plant_x = Named("state", {s.name: x_by[s.name] for s in plant.states})
    local = _Locals(terms, t, x_by, u_by, p_by, [s.name for s in plant.inputs])

    inputs_there, input_rates = local.through("input", u_by)
    at = (plant_x, Named("input", inputs_there), plant_p)
    motion = motion_of(plant, at)
    efforts, effort_rates, rates = _resolve_acceleration(plant, local, motion, at)
    known = {**input_rates, **effort_rates, **rates}
    measured, output_rates = local.through("output", outputs_of(plant, at, _sums(plant, efforts)), known)

    term_rates = {**input_rates, **effort_rates, **output_rates}
    x_dot = ca.vertcat(*[rates[s.name] if s.name in rates else term_rates[s.name] for s in states])
    y = ca.vertcat(*[measured[s.name] for s in plant.outputs])
    moved = ca.vertcat(
        *[ca.horzcat(motion[q.name].position, motion[q.name].velocity) for q in plant.equation_ports]
    )
    args, names = [t, x, u, p], ["t", "x", "u", "p"]
    with blamed_on(plant):  # a symbol of its own that is none of the arguments
        f = ca.Function("f", args, [x_dot], names, ["x_dot"], {"cse": True})
        h = ca.Function("h", args, [y], names, ["y"], {"cse": True})
        effort = ca.Function("efforts", args, [ca.vertcat(*efforts.values())], names, ["effort"])
        motions = ca.Function("motions", args, [moved], names, ["motion"])
    for function in (f, h):
        check_numbers(function, plant, f"the equations of plant {plant.name}, or of an effect at it,")
    return f, h, effort, motions


def _symbols(names: Sequence[str]) -> tuple[ca.SX, dict[str, ca.SX]]:
    symbols = [ca.SX.sym(name) for name in names]
    return ca.vertcat(*symbols), dict(zip(names, symbols, strict=True))


def _carried(port: Port, loads: Mapping[str, Load]) -> dict[str, ca.SX]:
    """What a port carries, for an effect there; zero where it has none."""
    at = loads.get(port.name, Load())
    return {
        "drive": ca.SX(at.drive),
        "load": ca.SX(at.load),
        "level": ca.SX(at.level),
        "load_width": ca.SX(LOAD_WIDTH * port.effort_scale),
    }


@dataclass(frozen=True)
class _Locals:
    """Gives each term the quantities at its port."""

    terms: Sequence[Term]
    t: ca.SX
    x: Mapping[str, ca.SX]
    u: Mapping[str, ca.SX]
    p: Mapping[str, ca.SX]
    inputs: Sequence[str]

    def see(self, term: Term, **seen: ca.SX) -> Local:
        p = {q.name: self.p[f"{term.name}.{q.name}"] for q in term.effect.parameters}
        z = {s.name: self.x[f"{term.name}.{s.name}"] for s in term.effect.states}
        own = {"p": Named("parameter", p), "z": Named("state", z), "channels": Named("channel", self.u)}
        return Local(time=self.t, **own, **seen)

    def at_effort_port(
        self, term: Term, port: Port, motion: Motion, acceleration: ca.SX, loads: Mapping[str, Load]
    ) -> Local:
        return self.see(
            term,
            epsilon=self.p[f"{port.name}.epsilon"],
            position=motion.position,
            velocity=motion.velocity,
            acceleration=acceleration,
            **_carried(port, loads),
        )

    def at_flow_port(
        self, term: Term, port: Port, motion: Motion, rate: ca.SX, loads: Mapping[str, Load]
    ) -> Local:
        """The level, its rate, the net flow and the supply; an effect that asks for more is refused."""
        absent = {"acceleration": ca.SX.sym("a"), "epsilon": ca.SX.sym("epsilon")}
        known = {"position": motion.position, "velocity": motion.velocity, "rate": rate}
        seen = self.see(term, **known, **absent, **_carried(port, loads))
        law = law_of(term.effect, seen)
        used = ca.vertcat(law, *self.rates(term, seen).values())
        if ca.depends_on(used, ca.vertcat(*absent.values())):
            raise ValueError(
                f"effect {term.effect.id}: flow port {port.name} has a level and a net flow, but no "
                "acceleration and no smoothed sign of a velocity"
            )
        if ca.depends_on(law, rate):
            raise ValueError(
                f"effect {term.effect.id}: its flow at {port.name} uses the rate that it changes"
            )
        return seen

    def rates(self, term: Term, local: Local) -> dict[str, ca.SX]:
        return {f"{term.name}.{name}": rate for name, rate in dynamics_of(term.effect, local).items()}

    def through(
        self, kind: str, signals: Mapping[str, ca.SX], known: Mapping[str, ca.SX] | None = None
    ) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
        """Signals after the terms on their path, and the rates of those terms' states; ``known`` are those of
        the states before them."""
        passed, rates = dict(signals), dict[str, ca.SX]()
        for term in self.terms:
            if term.effect.kind == kind:
                signal = passed[term.port]
                needs_rate = "rate" in term.effect.needs
                rate = self.rate_of(term, signal, {**(known or {}), **rates}) if needs_rate else ca.SX(0)
                local = self.see(term, signal=signal, rate=rate)
                passed[term.port] = passed[term.port] + law_of(term.effect, local)
                rates.update(self.rates(term, local))
        return passed, rates

    def rate_of(self, term: Term, signal: ca.SX, rates: Mapping[str, ca.SX]) -> ca.SX:
        """The rate of change of an output, by those of the states."""
        if ca.depends_on(signal, ca.vertcat(*[self.u[name] for name in self.inputs])):
            raise ValueError(f"effect {term.effect.id}: output {term.port} depends on an input at once")
        return ca.jtimes(signal, ca.vertcat(*[self.x[n] for n in rates]), ca.vertcat(*rates.values()))


def _sums(plant: Plant, efforts: Mapping[tuple[str, str], ca.SX]) -> dict[str, ca.SX]:
    """The sum of the efforts, or of the flows, at each port."""
    total = {port.name: ca.SX(0) for port in plant.equation_ports}
    for (_, port), effort in efforts.items():
        total[port] += effort
    return total


def _resolve_acceleration(
    plant: Plant,
    local: _Locals,
    motion: Mapping[str, Motion],
    plant_at: Symbols,
) -> tuple[dict[tuple[str, str], ca.SX], dict[str, ca.SX], Mapping[str, ca.SX]]:
    """Efforts by term and port, term rates and plant rates, with port accelerations and the rates of levels
    eliminated.

    An effect may use the port's acceleration a (added inertia). The equations of motion are
    affine in the efforts and therefore in a: one Newton step solves ``a = g(a)`` exactly. Where a rig
    prescribes the motion, a is given. The rate of a level follows from the flows, which do not depend on it.

    Raises:
        ValueError: if an effect is not linear in the acceleration, or uses one at a flow port.
    """
    moving = [port.name for port in plant.equation_ports if port.kind == "effort"]
    a = ca.vertcat(*[ca.SX.sym(f"a_{name}") for name in moving])
    flowing = {port.name: ca.SX.sym(f"r_{port.name}") for port in plant.equation_ports if port.kind == "flow"}
    loads = loads_of(plant, plant_at)
    efforts: dict[tuple[str, str], ca.SX] = {}
    term_rates: dict[str, ca.SX] = {}
    acting = [(term, name) for term in local.terms if term.effect.in_equations for name in term.ports]
    for term, name in acting:
        port = plant.port(name)
        if term.effect.into and name == term.ports[1]:
            share = local.p[f"{term.name}.{term.effect.into}"]
            efforts[term.name, name] = -share * efforts[term.name, term.ports[0]]
            continue
        if name in moving:
            seen = local.at_effort_port(term, port, motion[name], a[moving.index(name)], loads)
        else:
            seen = local.at_flow_port(term, port, motion[name], flowing[name], loads)
        efforts[term.name, name] = law_of(term.effect, seen)
        term_rates.update(local.rates(term, seen))
    rates = rates_of(plant, plant_at, _sums(plant, efforts))
    state = ca.vertcat(*[getattr(plant_at[0], s.name) for s in plant.states])
    state_rate = ca.vertcat(*[rates[s.name] for s in plant.states])
    for name, rate in flowing.items():
        level_rate = ca.jtimes(motion[name].position, state, state_rate)
        term_rates = {of: ca.substitute(value, rate, level_rate) for of, value in term_rates.items()}
    used = ca.vertcat(*efforts.values(), *term_rates.values())
    if not moving or not ca.depends_on(used, a):
        return efforts, term_rates, rates
    velocity = ca.vertcat(*[motion[name].velocity for name in moving])
    follows = ca.jtimes(velocity, state, state_rate)
    given = [motion[name].acceleration for name in moving]
    gap = a - ca.vertcat(*[follows[k] if one is None else one for k, one in enumerate(given)])
    if not ca.is_linear(gap, a):
        bent = [name for (name, _), value in efforts.items() if not ca.is_linear(ca.SX(value), a)]
        raise ValueError(f"{', '.join(bent) or plant.name}: the acceleration must enter linearly")
    zero = ca.substitute(gap, a, ca.SX.zeros(a.shape))
    solved = -ca.solve(ca.jacobian(gap, a), zero)
    insert = lambda value: ca.substitute(ca.SX(value), a, solved)  # noqa: E731
    return (
        {name: insert(value) for name, value in efforts.items()},
        {name: insert(value) for name, value in term_rates.items()},
        {name: insert(value) for name, value in rates.items()},
    )
