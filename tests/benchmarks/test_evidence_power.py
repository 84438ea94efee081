"""The study of the evidence: what it draws, and that its counts can go either way."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.evidence_power import ACTS, NOISES, RATE, counted, drawn, main


@pytest.mark.parametrize("noise", NOISES)
@pytest.mark.parametrize("acts", ACTS)
def test_the_first_candidate_takes_its_share_of_the_error(noise, acts):
    errors, candidates = drawn(noise, acts, 600, 0.2, 2, np.random.default_rng(1))
    assert candidates.shape == (2, 600 * RATE)
    amplitude = errors @ candidates[0] / (candidates[0] @ candidates[0])
    left = (errors - amplitude * candidates[0]).std() / errors.std()
    assert left == pytest.approx(0.8, abs=0.03)


def test_more_is_seen_where_more_is_missing():
    none, much = (counted("white", "always", 12, share, 6, 10, seed=1) for share in (0.0, 0.4))
    assert none == {"horizons": 0.0, "blocks": 0.0, "both sides": 0.0}
    assert much["blocks"] == much["both sides"] == 1.0


def test_what_acts_now_and_then_is_seen_in_blocks():
    seen = counted("white", "now and then", 30, 0.4, draws=6, count=10, seed=1)
    assert seen["blocks"] > seen["horizons"]


def test_the_table_is_written(tmp_path, monkeypatch):
    monkeypatch.setattr("benchmarks.evidence_power.OUT", tmp_path)
    monkeypatch.setattr("benchmarks.evidence_power.SECONDS", (6,))
    said = []
    table = main(["--draws", "1", "--candidates", "2"], said.append)
    assert len(table) == 3 * len(ACTS) * len(NOISES)
    assert "simulated" in said[0]
    assert (
        (tmp_path / "evidence_power.csv")
        .read_text()
        .startswith("noise,acts,seconds,missing,horizons,blocks,both sides")
    )
