"""The recordings of the study ``strangers``, all simulated; ``tests/hybridid_cli/new`` fits the others."""

from __future__ import annotations

import io

import numpy as np
import pytest

from benchmarks.strangers.play import Outcome, machines
from benchmarks.strangers.report import table
from benchmarks.strangers.rigs import FINE, GAP, LEVEL, _pushed, free_swing
from benchmarks.strangers.tanks import EDGE, overflowing, two_tanks
from pipelines.new.template import kinds


def columns(text: str) -> np.ndarray:
    return np.loadtxt(io.StringIO(text), delimiter=",", skiprows=1).T


def test_every_template_has_a_machine():
    assert {one.template for one in machines()} == set(kinds())


def test_the_damper_pushes_in_contact_alone():
    """Nothing over the first half of the gap; then up to the friction; nothing again over twice the gap."""
    q = np.concatenate([np.linspace(0, 4e-3, 4000 * FINE), np.linspace(4e-3, -4e-3, 8000 * FINE)])
    force = _pushed(q)
    assert not force[q[: len(force)] < 0.99 * GAP][: 900 * FINE].any()
    assert force.max() == pytest.approx(LEVEL, rel=1e-3)
    assert force.min() == pytest.approx(-LEVEL, rel=1e-3)
    back = force[4000 * FINE :]
    free = np.sum(back == 0) * 1e-6 / FINE  # m
    assert free == pytest.approx(2 * GAP, rel=0.01)


def test_a_swing_loses_what_its_frictions_take():
    """Coulomb friction ends a free swing; without it, it would swing for ever."""
    _, angle = columns(free_swing(20.0).text)
    late = np.abs(angle[-500:]).max()
    assert 10 < late < 40 < angle[0]
    assert len(free_swing(2.0, more=(25.0, 40.0)).more) == 2


def test_a_tank_spills_over_its_edge():
    (_, _, spilling, below), (_, _, whole, also) = (
        columns(make(1000.0).text) for make in (overflowing, two_tanks)
    )
    over = whole > 100 * EDGE
    assert over.any()
    first = int(np.argmax(over))
    assert spilling[:first] == pytest.approx(whole[:first], rel=0.1)
    assert spilling[over].max() < whole[over].max()
    assert below[-100:].mean() <= also[-100:].mean() + 0.1


def test_the_table_counts_what_is_quick():
    rows = [
        Outcome("slide", "carriage", (2.0, 9.0, 30.0), (1.0, 3.0, 12.0), "Nothing is missing.", 0.01, "M"),
        Outcome("slow", "blank", (2.0, 9.0, 300.0), (1.0, 3.0, 12.0), "Nothing is missing.", None, ""),
    ]
    text = table(rows)
    assert "simulated" in text
    assert "| slide | carriage | 2, 9, 30 | 16 | 1.00% (M) | Nothing is missing. |" in text
    assert text.endswith("at most 5 minutes: 1 of 2")
