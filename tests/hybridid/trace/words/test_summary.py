"""What a trace writes of a parameter."""

from __future__ import annotations

import math

import pytest

from hybridid.declarations import Parameter
from hybridid.trace.words.summary import _told


@pytest.mark.parametrize(
    ("std", "known"),
    [(0.1, True), (2.0, True), (3.0, False), (1e-12, False), (math.nan, False)],
)
def test_an_interval_that_says_nothing_is_left_out(std, known):
    """Of a sharpness between 2 and 10: wider than that, or as narrow as a rounding error."""
    found = _told(Parameter("n", "1", 4.0, 2.0, 10.0), 4.0, std)
    assert (found.value, found.unit) == (4.0, "1")
    assert found.std == pytest.approx(std if known else math.nan, nan_ok=True)
