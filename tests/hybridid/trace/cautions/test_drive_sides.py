"""An input that changes only in horizons that judge is told: no parameter of the drive could be fitted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.trace.cautions.drive_sides import drive_changes_on_one_side
from hybridid.trace.horizons.split import by_blocks


@pytest.mark.parametrize(
    ("edges", "said"),
    [
        ((75,), "force changes in no fitted horizon, so"),
        ((25,), "force changes in no horizon that judges, so"),
        ((25, 75), ""),
        ((), ""),
        ((48, 75), "force changes in no fitted horizon, so"),
    ],
)
def test_where_one_side_holds_no_edge_it_is_told(make_model, carriage, edges, said):
    """Horizons of 50 samples take turns; the last five of each serve neither side."""
    record = carriage.record(n=500)
    samples = np.arange(record.n)
    force = sum((np.where(samples >= edge, 1.0, 0.0) for edge in edges), np.zeros(record.n))
    split = by_blocks([replace(record, inputs=force[:, None])], 50)
    assert drive_changes_on_one_side(make_model(), split).startswith(f" Beware: {said}" if said else "")
    assert bool(drive_changes_on_one_side(make_model(), split)) is bool(said)
