"""Held-out records that leave the range of outputs, inputs, speeds and loads that was fitted.

A model says little of where it was not fitted: a held-out error there is one of extrapolation. A range is
that of 99.9 % of the samples. The range of a position on which nothing depends says nothing: the machine is
the same at every place.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.advice.advice import Advice
from hybridid.blame import Named
from hybridid.estimators.estimate import Estimate
from hybridid.estimators.problem import Problem
from hybridid.model import Model
from hybridid.model.asked import loads_of
from hybridid.model.groups import weighted
from hybridid.quantities import span
from hybridid.records.record import Record
from hybridid.simulation.initial import measured_states, observed

Array = NDArray[np.float64]
OUTSIDE = 5e-4
"""Share of the samples on each side of a range."""
BEYOND = 0.1
"""Of the fitted range, that a held-out record may leave it by; of the value where that was one alone."""


def out_of_range(problem: Problem, estimate: Estimate, held_out: Sequence[Record]) -> Iterator[Advice]:
    """Each held-out record that leaves what was fitted, with both ranges."""
    if not held_out:
        return
    model, p = problem.model, problem.model.values(estimate.values)
    units, fitted = _quantities(model, p, problem.records)
    for record in held_out:
        own = _quantities(model, p, [record])[1]
        left = [_left(what, units[what], fitted[what], own[what]) for what in fitted]
        said = [one for one in left if one]
        if said:
            yield Advice(
                "range",
                f"record {record.name} leaves what was fitted: {'; '.join(said)}; its errors are those of "
                "extrapolation too",
            )


def _left(what: str, unit: str, fitted: Array, own: Array) -> str:
    """Both ranges in words, where the second leaves the first; else nothing."""
    low, high = np.quantile(fitted, [OUTSIDE, 1 - OUTSIDE])
    least, most = np.quantile(own, [OUTSIDE, 1 - OUTSIDE])
    margin = BEYOND * ((high - low) or max(abs(high), abs(most)))
    if least >= low - margin and most <= high + margin:
        return ""
    widths = [width for width in (high - low, most - least) if width > 0]
    beside = max(map(abs, (low, high, least, most))) / min(widths) if widths else 1.0
    digits = 3 + max(0, int(np.log10(max(beside, 1.0))))  # enough to see how wide either range is
    return f"{what} {span(least, most, unit, digits)}, fitted {span(low, high, unit, digits)}"


def _quantities(model: Model, p: Array, records: Sequence[Record]) -> tuple[dict[str, str], dict[str, Array]]:
    """Units and samples of every quantity, over all ``records`` together."""
    units: dict[str, str] = {}
    parts: dict[str, list[Array]] = {}
    for record in records:
        for what, (unit, samples) in _of_record(model, p, record).items():
            units[what] = unit
            parts.setdefault(what, []).append(samples)
    return units, {what: np.concatenate(samples) for what, samples in parts.items()}


def _of_record(model: Model, p: Array, record: Record) -> dict[str, tuple[str, Array]]:
    everywhere, idle = _alike_everywhere(model), _without_effect(model)
    found = {
        c.name: (c.unit, record.output(c.name)) for c in record.output_channels if c.name not in everywhere
    }
    found |= {
        c.name: (c.unit, record.input(c.name))
        for c in record.input_channels
        if not (c.constant or c.name in idle)
    }
    own = len(model.plant.states)
    if not all(observed(model)[:own]):
        return found
    states = measured_states(model, record)
    given = (record.time[None, :], states.T, record.inputs.T)
    moved = np.asarray(model.motions.map(record.n)(*given, ca.repmat(ca.DM(p), 1, record.n)))
    ports = model.equation_ports
    for k, port in enumerate(ports):
        if port.kind == "effort":
            velocity = moved.reshape(len(ports), record.n, 2)[k, :, 1]
            found[f"speed at {port.name}"] = (f"{port.position_unit}/s", velocity)
    return found | _loads(model, p, record, states)


def _alike_everywhere(model: Model) -> set[str]:
    """The outputs that are linear in states on which no equation of motion depends: at every value of such an
    output the machine is the same."""
    t, x, u, p = _arguments(model)
    acting = set(ca.jacobian(model.f(t, x, u, p), x).sparsity().get_triplet()[1])
    slopes = ca.jacobian(model.h(t, x, u, p), x)
    return {
        output.name
        for k, output in enumerate(model.outputs)
        if slopes[k, :].nnz()
        and acting.isdisjoint(slopes[k, :].sparsity().get_triplet()[1])
        and not ca.depends_on(slopes[k, :], x)
    }


def _without_effect(model: Model) -> set[str]:
    """The inputs on which neither an equation of motion nor an output depends, as the angle of a shaft whose
    speed alone is measured."""
    t, x, u, p = _arguments(model)
    used = ca.which_depends(ca.vertcat(model.f(t, x, u, p), model.h(t, x, u, p)), u, 1, False)
    return {signal.name for signal, acts in zip(model.inputs, used, strict=True) if not acts}


def _arguments(model: Model) -> tuple[ca.SX, ...]:
    """Symbols of time, states, inputs and parameters."""
    sizes = (1, len(model.states), len(model.inputs), len(model.parameters))
    return tuple(ca.SX.sym(name, size) for name, size in zip("txup", sizes, strict=True))


def _loads(model: Model, p: Array, record: Record, states: Array) -> dict[str, tuple[str, Array]]:
    """What each port that declares a load carries, without the effects on the inputs' paths."""
    ports = [port for port in model.equation_ports if port.load]
    if not ports:
        return {}
    x, u, q = (
        ca.SX.sym(name, count)
        for name, count in (("x", states.shape[1]), ("u", record.inputs.shape[1]), ("p", len(p)))
    )
    known = {s.name: q[k] for k, s in enumerate(model.parameters)}
    inputs = {s.name: u[k] for k, s in enumerate(model.inputs)}
    known |= weighted(model.groups, inputs, known)
    at = (
        Named("state", {s.name: x[k] for k, s in enumerate(model.plant.states)}),
        Named("input", inputs),
        Named("parameter", {s.name: (known | inputs)[s.name] for s in model.plant.parameters}),
    )
    loads = loads_of(model.plant, at)
    function = ca.Function("loads", [x, u, q], [ca.vertcat(*[loads[port.name].load for port in ports])])
    values = np.asarray(function.map(record.n)(states.T, record.inputs.T, ca.repmat(ca.DM(p), 1, record.n)))
    return {
        f"load at {port.name}": (port.effort_unit, row)
        for port, row in zip(ports, values, strict=True)
        if np.isfinite(row).all()
    }
