"""Keys of records that a command line may give though the case's file does not."""

from __future__ import annotations

import pytest

from hybridid_cli.words import prepared


@pytest.mark.parametrize(
    ("word", "new"),
    [
        ("signals.resample=0.005", True),
        ("records.swing.resample=0.005", True),
        ("signals.simulated=true", True),
        ("records.swing.steps=[{step: mask, stretches: [[1, 2]]}]", True),
        ("signals.resampel=0.005", False),
        ("signals.time.column=t", False),
        ("records.swing.role=validation", False),
        ("records.resample=0.005", False),
        ("estimator.loss=huber", False),
    ],
)
def test_which_words_may_add_a_key(word, new):
    assert prepared("fit", [word]) == [f"++{word}" if new else word]
