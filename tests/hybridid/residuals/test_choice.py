"""The network that is kept: of a small size whose seeds together are nearly the best."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.residuals.choice import NEAR, chosen_by_size, chosen_network
from hybridid.residuals.narx import Weights


@pytest.fixture
def sized(trained):
    """``sized(weights, held_out)``: a network of that many weights that leaves that error."""

    def make(weights, held_out):
        architecture = replace(trained.network.architecture, width=weights)
        own = Weights((np.zeros((1, weights)),), ())
        network = replace(trained.network, members=(own,), architecture=architecture)
        return replace(trained, network=network, held_out=held_out, zero=10.0)

    return make


def test_a_smaller_one_nearly_as_good_is_kept(sized):
    small, large = sized(100, 1.0 * NEAR), sized(900, 1.0)
    assert chosen_network([large, small]) is small


def test_a_clear_gain_is_worth_its_weights(sized):
    small, large = sized(100, 1.001 * NEAR), sized(900, 1.0)
    assert chosen_network([small, large]) is large


def test_of_one_size_the_lowest(sized):
    assert chosen_network([sized(100, 1.01), best := sized(100, 1.0)]) is best


def test_one_lucky_seed_does_not_choose_its_size(sized):
    lucky = [sized(100, 0.5), sized(100, 3.0), sized(100, 3.0)]
    steady = [sized(900, 1.0), sized(900, 1.1), best := sized(900, 0.9)]
    assert chosen_network([*lucky, *steady]) is best


def test_one_standard_error_of_the_best_counts_as_equal():
    """Means 1.0 ± 0.1 and 1.09: within one standard error, though not within 5 %."""
    spread = [1.0 - 0.1 * 3**0.5, 1.0, 1.0 + 0.1 * 3**0.5]
    assert np.std(spread, ddof=1) / 3**0.5 == pytest.approx(0.1)
    assert chosen_by_size([[1.09, 1.09, 1.08], spread], [100, 900]) == (0, 2)
    assert chosen_by_size([[1.11, 1.11, 1.11], spread], [100, 900]) == (1, 0)


def test_no_network_is_the_smallest_size(sized):
    """``sized`` networks have the error of ``trained.zero`` without correction."""
    zero = sized(100, 1.0).zero
    assert chosen_network([sized(100, zero / NEAR)]) is None
    assert chosen_network([sized(100, 0.999 * zero / NEAR)]) is not None
    loose = [sized(100, 0.7 * zero), sized(100, 0.9 * zero), sized(100, 1.3 * zero)]
    assert chosen_network(loose) is None


def test_one_that_ran_away_is_out(sized):
    assert chosen_network([sized(10, np.inf), kept := sized(900, 2.0)]) is kept
    with pytest.raises(ValueError, match="every network for y diverged"):
        chosen_network([sized(10, np.inf)])


def test_a_size_with_a_seed_that_ran_away_is_chosen_only_if_all_have_one():
    assert chosen_by_size([[np.inf, 0.5], [1.0, 1.0]], [100, 900]) == (1, 0)
    assert chosen_by_size([[np.inf, 0.5], [1.0, np.inf]], [100, 900]) == (0, 1)
