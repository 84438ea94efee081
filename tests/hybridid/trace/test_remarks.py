"""What a network finds beside the last model is told for what it is."""

from dataclasses import replace

import pytest

from hybridid.trace.completeness import Completeness
from hybridid.trace.remarks import completeness_in_words


@pytest.mark.parametrize(
    ("gain", "p_value", "complete", "said"),
    [
        (
            0.431,
            0.017,
            True,
            "At the level of 1 % that is not shown to be more than chance, which does not say that nothing "
            "is missing",
        ),
        (
            0.041,
            0.0005,
            True,
            "That is less than 5 %: it finds nothing more worth having",
        ),
        (0.431, 0.0005, False, "That gain does not survive other ways of solving the equations"),
    ],
)
def test_a_gain_that_is_not_significant_is_no_proof_that_nothing_is_missing(
    nothing, gain, p_value, complete, said
):
    network = Completeness("12 bumps over v at cart", gain, p_value, complete, gain, "")
    assert completeness_in_words(replace(nothing(), completeness=network)).endswith(said)
