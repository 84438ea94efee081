"""A part's columns are the derivatives that CasADi gives of its value."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from hybridid.simulation.integrators import INTEGRATORS, RK4_TIMES
from hybridid.simulation.sensitivities import Part, output_part, step_part, total_derivative

FREE = ("M", "carriage.coulomb.f_c", "carriage.dahl.s")
EFFECTS = ("viscous", "coulomb", "dahl", "sensor_lag")


def evaluated(part: Part, given) -> tuple[np.ndarray, np.ndarray]:
    """The value (n,), and the derivatives of all stages, one after another, as the C computes them."""
    x, t, h, u, p = given
    if part.stages == 1:
        value, *d = (np.array(one).ravel() for one in part.forward(*given))
        return value, np.concatenate(d)
    rates, d, hops = [], [], np.array([0, part.hop, part.hop, 2 * part.hop])
    for share, hop in zip(RK4_TIMES, hops, strict=True):
        there = x + share * h * rates[-1] if rates else x
        inputs = u[hop : hop + (part.hop or len(u))]
        rate, *slope = (np.array(one).ravel() for one in part.forward(there, t + share * h, h, inputs, p))
        rates.append(rate)
        d += slope
    return x + h / 6 * (np.array([1, 2, 2, 1]) @ np.array(rates)), np.concatenate(d)


def columns(part: Part, given, s) -> np.ndarray:
    """The value's sensitivities (n, columns), one column after another."""
    assert part.column is not None
    _, d = evaluated(part, given)
    size, n_x = part.column.size1_in(2), len(s)
    places = [part.entries + k * part.own_rows for k in range(s.shape[1] - n_x)]
    own = [np.zeros(size)] * n_x + [d[place : place + size] for place in places]
    return np.hstack([np.array(part.column(s[:, j], d, own[j], given[2])) for j in range(s.shape[1])])


def expected(model, step, given, s) -> np.ndarray:
    x, p, columns = ca.SX.sym("x", len(model.states)), ca.SX.sym("p", len(model.parameters)), ca.SX(s)
    known_x, t, h, u, known_p = given
    value = step(t, x, u, p, h)
    return np.array(
        ca.Function("V", [x, p], [ca.densify(total_derivative(model, value, x, p, columns, FREE))])(
            known_x, known_p
        )
    )


def at_random(model, inputs):
    """Somewhere in the range of the carriage: (x, t, h, u, p) and S."""
    draw = np.random.default_rng(5).normal
    n_x = len(model.states)
    return (draw(size=n_x) * 0.1, 0.3, 1e-3, draw(size=inputs), model.values()), draw(
        size=(n_x, n_x + len(FREE))
    )


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize(("integrator", "wide"), [("rk4", False), ("rodas3", False), ("rodas3", True)])
def test_a_step(make_model, integrator, wide, held):
    model = make_model(EFFECTS)
    given, s = at_random(model, 1 if held else 3)
    part = step_part("step", model, integrator, held, FREE, wide)
    step = INTEGRATORS[integrator](model, ca.SX.sym("h"), held)
    x, t, h, u, p = given
    np.testing.assert_allclose(evaluated(part, given)[0], np.array(step(t, x, u, p, h)).ravel())
    np.testing.assert_allclose(
        columns(part, given, s), expected(model, step, given, s), rtol=1e-10, atol=1e-13
    )


def test_the_outputs(make_model):
    model = make_model(EFFECTS)
    given, s = at_random(model, 1)
    theirs = expected(model, lambda t, x, u, p, h: model.h(t, x, u, p), given, s)
    np.testing.assert_allclose(
        columns(output_part("y", model, FREE), given, s), theirs, rtol=1e-10, atol=1e-13
    )


def test_no_column_without_sensitivities(make_model):
    part = step_part("step", make_model(EFFECTS), "rk4", True, None)
    assert part.column is None
    assert part.functions == (part.forward,)
