"""Two scenarios of the league: a carriage that hides a drag, and one that hides nothing."""

from __future__ import annotations

import pytest

from benchmarks.league.machines import records_of
from benchmarks.league.scenario import Scenario
from benchmarks.league.scenarios import all_scenarios
from hybridid.records.record import Record


@pytest.fixture(scope="session")
def drag() -> tuple[Scenario, tuple[Record, Record]]:
    """The scenario, and its two records."""
    key = "carriage/carriage.quadratic_drag/large/noise1e-07/seed5"
    (one,) = (s for s in all_scenarios() if s.key == key)
    return one, records_of(one)


@pytest.fixture(scope="session")
def nothing() -> Scenario:
    """The scenario alone."""
    return next(s for s in all_scenarios() if s.category == "nothing" and s.machine == "carriage")
