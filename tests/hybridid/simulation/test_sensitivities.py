"""A part's columns are the derivatives that CasADi gives of its value."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from hybridid.simulation.integrators import INTEGRATORS
from hybridid.simulation.sensitivities import Part, output_part, step_part, total_derivative

FREE = ("M", "carriage.coulomb.f_c", "carriage.dahl.s")
EFFECTS = ("viscous", "coulomb", "dahl", "sensor_lag")


def columns(part: Part, given, s) -> np.ndarray:
    """The value's sensitivities (n, columns), one column after another."""
    assert part.column is not None
    entries = part.column.size1_in(1)
    d = np.array(part.forward(*given)[1]).ravel()
    own = [np.zeros(part.width)] * s.shape[0] + list(d[entries:].reshape(-1, part.width))
    return np.hstack(
        [np.array(part.column(s[:, j], d[:entries], own[j], given[2])) for j in range(s.shape[1])]
    )


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
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_step(make_model, integrator, held):
    model = make_model(EFFECTS)
    given, s = at_random(model, 1 if held else 3)
    part = step_part("step", model, integrator, held, FREE)
    step = INTEGRATORS[integrator](model, ca.SX.sym("h"), held)
    np.testing.assert_allclose(
        np.array(part.forward(*given)[0]), np.array(step(given[1], given[0], given[3], given[4], given[2]))
    )
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
