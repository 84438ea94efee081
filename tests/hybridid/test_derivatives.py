"""What every gradient stands on: the derivatives of each plant with each effect, against the complex step.

``Im f(x + i h) / h`` is exact to rounding and needs none of CasADi's derivatives. CasADi has no complex
numbers, so NumPy carries out its list of instructions here. Source: Squire and Trapp, Using complex
variables to estimate derivatives of real functions, SIAM Review 40 (1998).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import permutations

import casadi as ca
import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.rebuilt.tanks import Tanks
from hybridid.effects.library import EFFECTS
from hybridid.model import Model, Term
from hybridid.plants.duffing import Duffing
from hybridid.plants.emps import EMPS
from hybridid.plants.esea import ESEA
from hybridid.plants.flexible_link import FlexibleLink
from hybridid.plants.half_car import HalfCar
from hybridid.plants.plant import Plant
from hybridid.plants.servo import Servo

PLANTS = (Duffing, EMPS, ESEA, FlexibleLink, HalfCar, Servo)
Complex = NDArray[np.complex128]
STEP = 1e-30
"""Its square is lost beside 1, so nothing is cut off but that."""

BINARY: Mapping[int, Callable[[Complex, Complex], Complex]] = {
    ca.OP_ADD: lambda a, b: a + b,
    ca.OP_SUB: lambda a, b: a - b,
    ca.OP_MUL: lambda a, b: a * b,
    ca.OP_DIV: lambda a, b: a / b,
    ca.OP_POW: lambda a, b: a**b,
    ca.OP_CONSTPOW: lambda a, b: a**b.real,
    ca.OP_FMIN: lambda a, b: np.where(a.real <= b.real, a, b),
    ca.OP_FMAX: lambda a, b: np.where(a.real >= b.real, a, b),
    ca.OP_LT: lambda a, b: (a.real < b.real) + 0j,
    ca.OP_LE: lambda a, b: (a.real <= b.real) + 0j,
    ca.OP_EQ: lambda a, b: (a.real == b.real) + 0j,
    ca.OP_NE: lambda a, b: (a.real != b.real) + 0j,
    ca.OP_AND: lambda a, b: ((a.real != 0) & (b.real != 0)) + 0j,
    ca.OP_OR: lambda a, b: ((a.real != 0) | (b.real != 0)) + 0j,
    ca.OP_IF_ELSE_ZERO: lambda a, b: np.where(a.real != 0, b, 0),
}
UNARY: Mapping[int, Callable[[Complex], Complex]] = {
    ca.OP_ASSIGN: lambda a: a,
    ca.OP_NEG: lambda a: -a,
    ca.OP_EXP: np.exp,
    ca.OP_LOG: np.log,
    ca.OP_SQRT: np.sqrt,
    ca.OP_SQ: lambda a: a * a,
    ca.OP_TWICE: lambda a: a + a,
    ca.OP_INV: lambda a: 1 / a,
    ca.OP_SIN: np.sin,
    ca.OP_COS: np.cos,
    ca.OP_TAN: np.tan,
    ca.OP_ATAN: np.arctan,
    ca.OP_SINH: np.sinh,
    ca.OP_COSH: np.cosh,
    ca.OP_TANH: np.tanh,
    ca.OP_FABS: lambda a: np.where(a.real < 0, -a, a),
    ca.OP_SIGN: lambda a: np.sign(a.real) + 0j,
    ca.OP_FLOOR: lambda a: np.floor(a.real) + 0j,
    ca.OP_CEIL: lambda a: np.ceil(a.real) + 0j,
    ca.OP_NOT: lambda a: (a.real == 0) + 0j,
}


def slopes(function: ca.Function, *given: NDArray[np.float64]) -> NDArray[np.float64]:
    """Derivatives of all outputs by all inputs of ``function``, (n_out, n_in), each stacked."""
    at = np.concatenate(given)
    moved = at[:, None] + 1j * STEP * np.eye(len(at))
    return (
        np.vstack(_carried_out(function, np.split(moved, np.cumsum([len(g) for g in given])[:-1]))).imag
        / STEP
    )


def _carried_out(function: ca.Function, given: list[Complex]) -> list[Complex]:
    """The outputs for inputs (n, m): m points side by side."""
    points = given[0].shape[1]
    work: dict[int, Complex] = {}
    out = [np.zeros((function.size1_out(k), points), complex) for k in range(function.n_out())]
    rows = [function.sparsity_out(k).row() for k in range(function.n_out())]
    for k in range(function.n_instructions()):
        op, to, of = function.instruction_id(k), function.instruction_output(k), function.instruction_input(k)
        if op == ca.OP_CONST:
            work[to[0]] = np.full(points, function.instruction_constant(k), complex)
        elif op == ca.OP_INPUT:
            work[to[0]] = given[of[0]][of[1]]
        elif op == ca.OP_OUTPUT:
            out[to[0]][rows[to[0]][to[1]]] = work[of[0]]
        elif op in UNARY:
            work[to[0]] = UNARY[op](work[of[0]])
        else:
            work[to[0]] = BINARY[op](work[of[0]], work[of[1]])
    return out


def models(plant: Plant):
    """The plant alone, then with each effect at each port where it is possible."""
    yield Model(plant)
    for effect in EFFECTS:
        possible = [port.name for port in plant.ports if effect.possible_at(port)]
        for port in map("+".join, permutations(possible, 2)) if effect.into else possible:
            yield Model(plant, (Term(effect, port),))


def points(model: Model, random: np.random.Generator):
    """Times, states, inputs and parameters: far from rest, and so near that no sign(v) is saturated. No
    amplitude is zero, so that no effect is absent. The edge of a play is as wide as where a descent begins:
    far narrower than the play, it leaves the complex step no digits to compare with."""
    for size in (1.0, 1e-3):
        x = size * random.normal(size=len(model.states)) * [s.scale for s in model.states]
        p = [q.guess * random.uniform(0.5, 1.5) if q.guess else 0.3 * q.scale for q in model.parameters]
        p = [value * (100 if q.smooths == 2 else 1) for value, q in zip(p, model.parameters, strict=True)]
        yield [np.array([1.3]), x, random.normal(size=len(model.inputs)), np.array(p)]


def error(model: Model, random: np.random.Generator) -> float:
    """The largest error of the derivatives of x' and y by time, states, inputs and parameters, each over the
    size of what it is by: relative to itself, or to a ten-millionth of the largest of the same x' or y."""
    symbols = [ca.SX.sym("g", model.f.size1_in(k)) for k in range(model.f.n_in())]
    value, by = ca.vertcat(model.f(*symbols), model.h(*symbols)), ca.vertcat(*symbols)
    by_casadi = ca.Function("J", symbols, [ca.densify(ca.jacobian(value, by))])
    plain, worst = ca.Function("V", symbols, [value]), 0.0
    for at in points(model, random):
        found, expected = (
            slope * np.concatenate(at) for slope in (by_casadi(*at).full(), slopes(plain, *at))
        )
        assert np.isfinite(expected).all()
        least = 1e-7 * np.abs(expected).max(axis=1, keepdims=True) + 1e-300
        worst = max(worst, float(np.max(np.abs(found - expected) / (np.abs(expected) + least))))
    return worst


def wrong(plant: Plant) -> dict[str, float]:
    """The models of the plant whose derivatives err by more than rounding, with that error."""
    random = np.random.default_rng(1)
    errors = {" ".join([plant.name, *(t.name for t in m.terms)]): error(m, random) for m in models(plant)}
    assert len(errors) > 1
    return {name: found for name, found in errors.items() if not found < 1e-6}


@pytest.mark.parametrize("plant", PLANTS, ids=lambda plant: plant.name)
def test_every_effect_at_every_port(plant):
    assert wrong(plant()) == {}


def test_the_effects_that_no_plant_of_ours_has_a_port_for(pressed, tank):
    assert wrong(pressed) | wrong(tank) | wrong(Tanks()) == {}


def test_a_wrong_derivative_is_seen(monkeypatch):
    jacobian = ca.jacobian
    monkeypatch.setattr(ca, "jacobian", lambda value, by: jacobian(value, by) * 1.00001)
    assert len(wrong(Duffing())) > 20
