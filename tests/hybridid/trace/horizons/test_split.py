"""What is fitted and what is held out."""

from __future__ import annotations

import pytest

from hybridid.trace.horizons.split import FEWEST, by_blocks, by_record


def test_records_serve_one_way_each(carriage):
    first, second = carriage.record(400), carriage.record(300, name="second")
    split = by_record([first], [second], 50)
    assert split.fitted == tuple(range(8))
    assert split.held_out == tuple(range(8, 14))
    assert split.gap == 0
    assert split.described == "fitted on carriage, judged on second"


def test_blocks_alternate_with_a_gap(carriage):
    split = by_blocks([carriage.record(600)], 50)
    assert split.fitted == (0, 2, 4, 6, 8, 10)
    assert split.held_out == (1, 3, 5, 7, 9, 11)
    assert split.gap == 5
    assert not set(split.fitted) & set(split.held_out)


def test_too_few_horizons_for_a_verdict(carriage):
    with pytest.raises(
        ValueError, match=rf"at least {FEWEST} horizons .* gives 2 and 1: shorten trace.horizon"
    ):
        by_blocks([carriage.record(600)], 200)
