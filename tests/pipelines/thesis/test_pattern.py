"""The sentences on which rows improve most follow from the numbers."""

from __future__ import annotations

import pytest

from pipelines.thesis.pattern import Improved, pattern, reduction


def rows(*numbers):
    return [Improved(name, thesis, ours) for name, thesis, ours in numbers]


def test_a_reduction_is_in_percent_and_negative_where_the_error_grew():
    assert reduction(3.3253, 0.5018) == pytest.approx(84.91, abs=0.005)
    assert reduction(1.0, 1.25) == pytest.approx(-25.0)


def test_one_order_is_said_to_be_one():
    listed, order = pattern(rows(("a", 80.0, 60.0), ("b", 20.0, 5.0)), "measured")
    assert listed == "Improve most, thesis: a 80.0 %, b 20.0 %. Ours (measured): a 60.0 %, b 5.0 %."
    assert order == "Both orders are the same. Worse than their gray box, there and here: none."


def test_other_orders_and_rows_that_got_worse_are_named():
    found = pattern(rows(("a", 80.0, 10.0), ("b", 20.0, 50.0), ("c", -27.2, 5.0)), "simulated")[1]
    assert "The orders differ (2 of 3 pairs have the same order)" in found
    assert "a is 1st there and 2nd here" in found
    assert "b is 2nd there and 1st here" in found
    assert "c is" not in found  # third in both
    assert found.endswith("Worse than their gray box: c in the thesis, none here.")


def test_of_many_rows_the_first_are_named():
    many = rows(*((str(k), 90.0 - k, 10.0 + k) for k in range(9)))
    listed, order = pattern(many, "simulated")
    assert "0 90.0 %" in listed
    assert "and 4 more" in listed
    assert "(0 of 36 pairs have the same order): 0 is 1st there and 9th here." in order


def test_one_row_has_no_order():
    assert pattern(rows(("a", 80.0, 10.0)), "measured") == ()
