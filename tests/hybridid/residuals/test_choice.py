"""The network that is kept: small, and nearly the best on held-out blocks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.residuals.choice import NEAR, smallest_near_best
from hybridid.residuals.narx import Weights


@pytest.fixture
def sized(trained):
    """``sized(weights, held_out)``: a network of that many weights that leaves that error."""

    def make(weights, held_out):
        network = replace(trained.network, weights=Weights((np.zeros((1, weights)),), ()))
        return replace(trained, network=network, held_out=held_out)

    return make


def test_a_smaller_one_nearly_as_good_is_kept(sized):
    small, large = sized(100, 1.0 * NEAR), sized(900, 1.0)
    assert smallest_near_best([large, small]) is small


def test_a_clear_gain_is_worth_its_weights(sized):
    small, large = sized(100, 1.001 * NEAR), sized(900, 1.0)
    assert smallest_near_best([small, large]) is large


def test_of_one_size_the_lowest(sized):
    assert smallest_near_best([sized(100, 1.01), best := sized(100, 1.0)]) is best


def test_one_that_ran_away_is_out(sized):
    assert smallest_near_best([sized(10, np.inf), kept := sized(900, 2.0)]) is kept
    with pytest.raises(ValueError, match="every network for y diverged"):
        smallest_near_best([sized(10, np.inf)])
