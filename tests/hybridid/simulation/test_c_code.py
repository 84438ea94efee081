"""The C that is written of a CasADi function gives its numbers, in eight lanes, in four and in one."""

from __future__ import annotations

import ctypes

import casadi as ca
import numpy as np
import pytest

from hybridid.simulation import machine_code
from hybridid.simulation.c_code import Unwritten, c_of
from hybridid.simulation.compiler import c_compiler, compiled

pytestmark = pytest.mark.skipif(c_compiler() is None, reason="no C compiler on this machine")
CALL = "\nvoid call(const Lanes *x, const double *p, Lanes *y) {{ double c[{n}]; f_prepare(0.5, p, c); " \
    "f_run(x, x, x, 0.5, x, p, c, y, y); }}\n"  # fmt: skip


def written(function: ca.Function, lanes: int):
    """``(x (n, lanes), p) -> y (m, lanes)`` by the compiled C of ``function`` of x and p."""
    text = machine_code._side_by_side(lanes) + c_of(function, ("x", "p")) + CALL.format(n=1000)
    library = compiled(text, lambda: text)
    assert library is not None

    def run(x, p):
        given, found = aligned(np.shape(x)), aligned((function.size1_out(0), lanes))
        given[:], constants = x, np.array(p, dtype=float)
        library.call(*(ctypes.c_void_p(a.ctypes.data) for a in (given, constants, found)))
        return found

    return run


def aligned(shape):
    """Vectors lie at multiples of 64 bytes."""
    room = np.empty(int(np.prod(shape)) + 8)
    start = (-room.ctypes.data % 64) // 8
    return room[start : start + int(np.prod(shape))].reshape(shape)


def of(build, n=2):
    x, p = ca.SX.sym("x", n), ca.SX.sym("p", 2)
    return ca.Function("f", [x, p], [ca.densify(build(x, p))], {"cse": True})


LAWS = {
    "arithmetic": lambda x, p: ca.vertcat(
        x[0] + x[1], x[0] - p[0], x[0] * p[1] / x[1], -x[0], 2 * x[0], 1 / x[1]
    ),
    "parameters alone": lambda x, p: ca.vertcat(p[0] * p[1], ca.tanh(p[0]), p[0] < p[1]) * x[0],
    "conditions": lambda x, p: ca.vertcat(
        ca.if_else(x[0] > x[1], x[0], p[0]),
        ca.if_else(ca.logic_and(x[0] < 0, x[1] < 0), 1, 2),
        ca.if_else(ca.logic_or(x[0] <= 0, x[1] >= 0), 1, 2),
        ca.if_else(ca.logic_not(x[0] == x[1]), x[1], 3),
        x[0] != x[1],
    ),
    "kinks": lambda x, p: ca.vertcat(
        ca.fabs(x[0]), ca.sign(x[0]), ca.fmin(x[0], x[1]), ca.fmax(x[0], p[0]), ca.copysign(x[0], x[1])
    ),
    "library": lambda x, p: ca.vertcat(
        ca.sin(x[0]), ca.cos(x[0]), ca.sqrt(ca.fabs(x[0])), ca.log(1 + x[0] ** 2), ca.atan(x[0])
    ),
    "library of two": lambda x, p: ca.vertcat(
        (x[0] ** 2) ** p[1], ca.fabs(x[0]) ** 1.7, ca.atan2(x[0], x[1]), ca.fmod(x[0], p[1])
    ),
    "exponentials": lambda x, p: ca.vertcat(ca.exp(x[0]), ca.tanh(x[0]), ca.exp(p[0]) * x[1]),
}  # fmt: skip


@pytest.mark.parametrize("lanes", [1, 4, 8])
@pytest.mark.parametrize("law", LAWS)
def test_the_numbers_of_casadi(law, lanes):
    function = of(LAWS[law])
    ours, generator = written(function, lanes), np.random.default_rng(3)
    for _ in range(50):
        x, p = generator.normal(scale=3, size=(2, lanes)), generator.normal(size=2) ** 2 + 0.1
        x[:, 0] = np.round(x[:, 0])
        theirs = np.column_stack([function(x[:, k], p).full().ravel() for k in range(lanes)])
        np.testing.assert_allclose(ours(x, p), theirs, rtol=1e-15 if law == "arithmetic" else 2e-14, atol=0)


@pytest.mark.parametrize(("law", "exact"), [(ca.exp, np.exp), (ca.tanh, np.tanh)])
def test_exponentials_to_the_last_two_bits(law, exact):
    ours = written(of(lambda x, p: law(x[0]), n=1), 4)
    generator = np.random.default_rng(4)
    seen = np.concatenate([generator.normal(scale=s, size=4000) for s in (1e-8, 0.1, 0.7, 3.0, 100.0)])
    edges = [0.0, -0.0, 0.625, -0.625, 19.99, 20.01, 300, -300, 709.7, -708.3, 1e-300, 1e300, -1e300, 5e-324]
    x = np.concatenate([seen, edges, [np.inf, -np.inf]])
    x = np.append(x, np.zeros(-len(x) % 4)).reshape(-1, 4)
    with np.errstate(over="ignore"):
        expected = exact(x.ravel())
    found = np.concatenate([ours(row[None], [0.0, 0.0])[0] for row in x])
    np.testing.assert_allclose(found, expected, rtol=2.0**-51, atol=1e-323)
    np.testing.assert_array_equal(np.signbit(found), np.signbit(expected))


def test_powers_and_logarithms_over_the_whole_range():
    """To the last bits of the logarithm; a power to these times the size of its logarithm."""
    ours = written(of(lambda x, p: ca.vertcat(ca.log(x[0]), x[0] ** x[1])), 4)
    generator = np.random.default_rng(6)
    base = np.exp(generator.uniform(-1, 1, size=4000) * np.repeat([1e-6, 0.3, 3.0, 300.0], 1000))
    power = generator.normal(size=4000)
    edges = [0.0, -2.0, 1.0, 5e-324, 1e-310, 1e301, np.inf, np.nan, -0.0, 0.5, 2.0**0.5, 2.0**-0.5]
    x = np.array([[*base, *edges], [*power, 1.5, 3.0, 7.0, 1.0, 2.0, 1.5, 2.0, 0.0, 2.0, 0.0, 2.0, 2.0]])
    with np.errstate(all="ignore"):
        logarithm, raised = np.log(x[0]), np.power(x[0], x[1])
    found = np.hstack([ours(x[:, k : k + 4], [0.0, 0.0]) for k in range(0, x.shape[1], 4)])
    np.testing.assert_allclose(found[0], logarithm, rtol=2.0**-51, atol=0)
    with np.errstate(all="ignore"):
        room = 2.0**-51 * (1 + np.nan_to_num(np.abs(x[1] * logarithm), posinf=0.0))
        assert np.all(np.abs(found[1] / raised - 1)[:4000] < room[:4000])
    np.testing.assert_allclose(found[1, 4000:], raised[4000:], rtol=1e-15)


def test_roots_to_the_last_bit():
    ours = written(of(lambda x, p: ca.sqrt(x[0]), n=1), 4)
    seen = np.exp(np.random.default_rng(8).uniform(-300, 300, size=4000))
    x = np.array([[*seen, 0.0, -0.0, np.inf, np.nan, 5e-324, 1e-310, 1.7e308, -1.0]])
    found = np.hstack([ours(x[:, k : k + 4], [0.0, 0.0]) for k in range(0, x.shape[1], 4)])
    with np.errstate(invalid="ignore"):
        np.testing.assert_array_equal(found, np.sqrt(x))


def test_sines_to_the_last_bits_of_one():
    ours = written(of(lambda x, p: ca.vertcat(ca.sin(x[0]), ca.cos(x[0])), n=1), 4)
    draw = np.random.default_rng(7).normal
    seen = np.concatenate([draw(scale=scale, size=4000) for scale in (1e-9, 1.0, 100.0, 2e5, 1e9)])
    edges = [0.0, -0.0, np.pi, np.pi / 2, 3 * np.pi / 4, -np.pi / 4, np.inf, np.nan]
    x = np.array([[*seen, *edges]])
    found = np.hstack([ours(x[:, k : k + 4], [0.0, 0.0]) for k in range(0, x.shape[1], 4)])
    with np.errstate(invalid="ignore"):
        np.testing.assert_allclose(found, np.vstack([np.sin(x), np.cos(x)]), rtol=0, atol=2.0**-52)
    np.testing.assert_allclose(found[0, :4000], np.sin(x[0, :4000]), rtol=2.0**-52)


def test_no_number_in_one_lane_leaves_the_others_alone():
    ours = written(of(lambda x, p: ca.vertcat(ca.tanh(x[0]), ca.exp(x[0]), ca.fmin(x[0], 1.0)), n=1), 4)
    found = ours(np.array([[np.nan, 0.5, -0.5, 2.0]]), [0.0, 0.0])
    assert np.isnan(found[:2, 0]).all()
    assert found[2, 0] == 1.0
    np.testing.assert_allclose(found[0, 1:], np.tanh([0.5, -0.5, 2.0]), rtol=1e-15)


def test_an_operation_without_c_is_refused():
    with pytest.raises(Unwritten, match="has no C"):
        c_of(of(lambda x, p: ca.erfinv(x[0]), n=1), ("x", "p"))


def test_one_division_for_all_that_is_divided_by_the_same():
    text = c_of(of(lambda x, p: ca.vertcat(p[0] / x[0], x[1] / x[0], ca.exp(x[1]) / x[0]), n=3), ("x", "p"))
    assert text.count(" / ") == 1
