"""Steps of one record's own: two parts of one file may be two records."""

from __future__ import annotations

import pytest

from hybridid.records.store import load_record
from pipelines.preprocess import PREPROCESS
from pipelines.runner import run_stages
from pipelines.shared.errors import ConfigError


@pytest.mark.parametrize("source", ["auto", "simulated"])
def test_a_record_is_cut_before_what_all_records_pass(settings, data, heard, source):
    """The mean is that of the part, not of the file."""
    changed = settings(
        {
            "data": source,
            "records.first.steps": [{"step": "crop", "samples": [100, 400]}],
            "preprocess.steps": [{"step": "remove_mean", "signals": ["position"]}],
        }
    )
    tree = run_stages(changed, "preprocess", heard).tree
    first, second = (load_record(tree / f"preprocess/{name}.parquet") for name in ("first", "second"))
    assert first.n == 300
    assert first.time[0] == pytest.approx(0.1)
    assert second.n == 1201
    assert abs(first.output("position").mean()) < 1e-12


def test_a_wrong_step_of_a_record_is_said_before_anything_runs(settings, data):
    changed = settings({"records.first.steps": [{"step": "corp", "samples": [0, 4]}]})
    with pytest.raises(ConfigError, match=r"records.first.steps 1: unknown step 'corp'.*did you mean 'crop'"):
        PREPROCESS.check(changed)
