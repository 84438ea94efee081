"""Which pairs promise most, against least squares written down here, on small arrays."""

from __future__ import annotations

from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.trials.promise import Promise, most_promising, overlap, promised_alone, promises
from hybridid.trace.trials.sensitivity import Seen, Shape, without

N = 60


@pytest.fixture
def rng():
    return np.random.default_rng(3)


def effect(name, *look_alikes, port="cart"):
    made = SimpleNamespace(id=name, look_alikes=look_alikes)
    return SimpleNamespace(effect=made, name=f"{port}.{name}", ports=(port,))


def seen(candidate, residual, *columns, positive=False):
    blocks = [c.reshape(N, -1) for c in columns]
    shapes = [Shape(c, (positive,) * c.shape[1], {"shape": k}) for k, c in enumerate(blocks)]
    return Seen(candidate, tuple(shapes), residual)


def drop(residual, *columns):
    """By how much least squares lowers the squared residual, over that."""
    together = np.column_stack([c.reshape(N, -1) for c in columns])
    left = residual - together @ np.linalg.lstsq(together, residual, rcond=None)[0]
    return 1 - left @ left / (residual @ residual)


def test_the_promise_is_what_least_squares_gives_each_beside_the_other(rng):
    """Three effects with one amplitude and one with two, each in one shape or several."""
    shapes = [[rng.normal(size=N) for _ in range(2)], [rng.normal(size=(N, 2))], [rng.normal(size=N)]]
    shapes.append([rng.normal(size=N) for _ in range(3)])
    residual = shapes[0][1] - shapes[3][2] + 0.3 * rng.normal(size=N)
    found = promises([seen(effect(f"e{k}"), residual, *s) for k, s in enumerate(shapes)], 0.999)
    alone = [max(drop(residual, one) for one in each) for each in shapes]
    expected = {}
    for a, b in combinations(range(4), 2):
        both = max(drop(residual, one, other) for one in shapes[a] for other in shapes[b])
        shares = [(both - alone[k]) / (1 - alone[k]) for k in (a, b)]
        expected[f"cart.e{a}", f"cart.e{b}"] = min(shares)
    assert {(p.first.name, p.second.name): p.share for p in found} == pytest.approx(expected, abs=1e-6)
    assert (found[0].first.name, found[0].second.name) == ("cart.e0", "cart.e3")
    assert found[0].starts == ({"shape": 1}, {"shape": 2})


def test_two_that_help_only_together_come_first(rng):
    """Of two long columns that nearly cancel, neither alone fits their small difference."""
    common, small = 100 * rng.normal(size=N), rng.normal(size=N)
    columns = {"a": common + small, "b": common, "c": small + 2 * rng.normal(size=N), "d": rng.normal(size=N)}
    found = promises([seen(effect(name), small, c) for name, c in columns.items()], 0.99999)
    assert [found[0].first.effect.id, found[0].second.effect.id] == ["a", "b"]
    assert found[0].share > 0.9


def test_an_amplitude_that_cannot_be_negative_does_not_help_where_it_would_be(rng):
    a, b = rng.normal(size=N), rng.normal(size=N)
    for sign, promised in ((1, 1), (-1, 0)):
        residual = a + sign * b
        both = [seen(effect("a"), residual, a), seen(effect("b"), residual, b, positive=True)]
        assert len(promises(both, 0.999)) == promised


def test_look_alikes_with_nearly_the_same_columns_are_no_pair(rng):
    a, residual = rng.normal(size=N), rng.normal(size=N)
    near = a + 1e-3 * residual
    assert promises([seen(effect("a"), residual, a), seen(effect("b", "a"), residual, near)], 0.999) == []
    unrelated = promises([seen(effect("a"), residual, a), seen(effect("b"), residual, near)], 0.999)
    assert unrelated[0].share > 0.9
    apart = a + residual
    assert (
        len(promises([seen(effect("a"), residual, a), seen(effect("b", "a"), residual, apart)], 0.999)) == 1
    )


def test_one_effect_does_not_stand_twice_at_a_port():
    spring, drag = effect_named("linear_stiffness"), effect_named("quadratic_drag")
    both = Candidate(spring, "front+rear")
    assert overlap(both, Candidate(spring, "rear"))
    assert not overlap(both, Candidate(drag, "rear"))
    assert not overlap(Candidate(spring, "front"), Candidate(spring, "rear"))


def test_what_has_no_shape_promises_nothing(rng):
    residual = rng.normal(size=N)
    assert promises([Seen(effect("a")), seen(effect("b"), residual, rng.normal(size=N))], 0.999) == []
    assert promises([], 0.999) == []


def test_projection_of_each_horizon_is_that_of_least_squares(rng):
    """Also where a state is not seen, or two are seen as one."""
    given, states = rng.normal(size=(3, 4, 20)), rng.normal(size=(3, 3, 20))
    states[1, 2] = 0.0
    states[2, 2] = 2 * states[2, 1]
    for rows, known, left in zip(given, states, without(given, states), strict=True):
        fitted = np.linalg.lstsq(known.T, rows.T, rcond=1e-9)[0]
        assert left == pytest.approx(rows - (known.T @ fitted).T, abs=1e-9)
    assert np.array_equal(without(given, states[:, :0]), given)


def test_pairs_come_in_turn_by_what_they_take_together_and_by_the_smaller_share():
    def pair(name, share, together):
        return Promise(effect(name), effect("other"), ({}, {}), share, together)

    even, likely, hopeless = pair("even", 0.6, 0.7), pair("likely", 0.2, 0.9), pair("hopeless", 0.01, 0.99)
    by_share = [even, likely, hopeless]
    assert most_promising(by_share, least=0.1) == [likely, even, hopeless]
    assert most_promising(by_share, least=0.0) == [hopeless, even, likely]


def test_what_an_effect_promises_alone_is_the_share_of_its_best_shape(rng):
    first, second = rng.normal(size=N), rng.normal(size=N)
    one = seen(effect("a"), second + 0.1 * rng.normal(size=N), first, second)
    assert promised_alone(one) == pytest.approx(drop(one.residual, second), abs=1e-6)
    assert promised_alone(Seen(effect("b"))) == 0.0
