"""The study of the evidence: what it draws, and that its counts can go either way."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.evidence_power import NOISES, RATE, counted, drawn, main


@pytest.mark.parametrize("noise", NOISES)
def test_the_first_candidate_takes_its_share_of_the_error(noise):
    errors, candidates = drawn(noise, 600, 0.2, 2, np.random.default_rng(1))
    assert candidates.shape == (2, 600 * RATE)
    amplitude = errors @ candidates[0] / (candidates[0] @ candidates[0])
    left = (errors - amplitude * candidates[0]).std() / errors.std()
    assert left == pytest.approx(0.8, abs=0.03)


def test_more_is_seen_where_more_is_missing():
    none, much = (counted("white", 12, share, draws=6, count=10, seed=1) for share in (0.0, 0.4))
    assert none == {"horizons": 0.0, "blocks": 0.0}
    assert much["blocks"] == 1.0


def test_the_table_is_written(tmp_path, monkeypatch):
    monkeypatch.setattr("benchmarks.evidence_power.OUT", tmp_path)
    monkeypatch.setattr("benchmarks.evidence_power.SECONDS", (6,))
    said = []
    table = main(["--draws", "1", "--candidates", "2"], said.append)
    assert len(table) == 3 * len(NOISES)
    assert "simulated" in said[0]
    assert (tmp_path / "evidence_power.csv").read_text().startswith("noise,seconds,missing,horizons,blocks")
