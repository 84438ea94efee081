"""A constant effort that differs by recording is told, and one that all share is not."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.trace.horizons.split import by_record
from hybridid.trace.recordings.recording_offset import offset_by_recording
from hybridid.trace.refits.refit import refit
from hybridid.trace.rules import Rules

HORIZON = 50


@pytest.fixture
def said(make_model, carriage_like, noise):
    """``said(5.0, -5.0, 0.0)``: of carriages with these offsets in N, the last one judges."""

    def of(*offsets: float, **changes: str) -> str:
        records = [
            replace(
                carriage_like(offset=offset).record(400, noise=noise(400, 2e-6, seed=k), name=f"run{k}"),
                **changes,
            )
            for k, offset in enumerate(offsets)
        ]
        split = by_record(records[:-1], records[-1:], HORIZON)
        return offset_by_recording(refit(make_model(("viscous", "coulomb")), split), split, Rules())

    return of


def test_a_constant_effort_that_differs_by_recording_is_told(said):
    told = said(6.0, -6.0, 1.0)
    assert told.startswith(" A constant effort at carriage that differs by recording (")
    assert all(f" in run{k}" in told for k in range(3))
    assert "parameters.carriage.offset.offset.by=record" in told


def test_one_that_all_share_is_none_that_differs(said):
    assert said(6.0, 6.0, 6.0) == ""


def test_parts_of_one_file_are_one_recording(said):
    assert said(6.0, -6.0, 1.0, digest="the same") == ""
