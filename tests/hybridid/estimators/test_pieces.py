"""Short pieces of records, over which a cost has hardly any valleys."""

from __future__ import annotations

import pytest

from hybridid.estimators.pieces import pieces
from hybridid.estimators.problem import build_problem


@pytest.mark.parametrize(
    ("horizon", "share", "length"),
    [(1000, 1, 150), (1000, 10, 100), (300, 10, 50), (40, 10, 40), (None, 10, 150)],
)
def test_pieces_are_a_share_of_the_record_and_of_the_horizon(make_model, carriage, horizon, share, length):
    """3000 samples give 20 pieces of 150; a horizon of 1000 gives ten of 100; 50 are the fewest samples."""
    problem = build_problem(make_model(), [carriage.record(3000, 0.001)], horizon, 1)
    assert max(pieces(problem, share=share).windows.lengths) == length
