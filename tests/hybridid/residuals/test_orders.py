"""Orders signal by signal, and how wrong ones are refused."""

from __future__ import annotations

import pytest

from hybridid.residuals.orders import Orders, orders_of


def test_the_vehicle_of_the_thesis():
    orders = orders_of(7, 2, 4, ("u_f", "u_r"))
    assert orders == Orders(7, (2, 2), 4)
    assert (orders.regressors, orders.longest) == (15, 7)


def test_each_input_has_its_own():
    assert orders_of(1, {"u_r": 5}, 0, ("u_f", "u_r")).inputs == (0, 5)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ((-1, 2, 4), r"orders\.error is -1: at least 0"),
        ((1, -2, 4), r"orders\.inputs is -2"),
        ((0, 0, 0), "see nothing"),
        ((1, {"u_q": 2}, 0), "'u_q': did you mean 'u_r'?"),
    ],
)
def test_refusals(given, words):
    with pytest.raises(ValueError, match=words):
        orders_of(*given, ("u_f", "u_r"))
