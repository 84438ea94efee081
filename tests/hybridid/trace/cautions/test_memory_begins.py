"""A law that remembers the load is told where a record begins under load: its memory begins at nothing."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.composed import law
from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.cautions import memory_begins
from hybridid.trace.cautions.memory_begins import memory_begins_empty
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refit import refit

REMEMBERS = law("proportional_of_recent_load_times_sign_of_velocity")


def _accepted(effect):
    candidate = Candidate(effect, "carriage")
    return SimpleNamespace(name=candidate.name, trial=SimpleNamespace(candidate=candidate))


@pytest.fixture
def traced(make_model, split_of):
    split = split_of()
    return refit(make_model(), split), split


@pytest.mark.parametrize(("at_start", "told"), [(0.0, False), (0.3, False), (0.8, True), (-2.0, True)])
def test_a_record_that_begins_under_load_is_told(traced, monkeypatch, at_start, told):
    """The first horizon's load: at first so many times its RMS."""
    load = np.array([at_start, *([1.0, -1.0] * 40)])
    seen = SimpleNamespace(motion=lambda port, variable: load)
    monkeypatch.setattr(memory_begins, "Path", SimpleNamespace(of=lambda *_: seen))
    said = memory_begins_empty([_accepted(REMEMBERS)], *traced)
    assert (REMEMBERS.id in said) is told


def test_the_load_of_a_record_is_that_of_its_first_horizon(traced):
    final, split = traced
    loads = [Path.of(final, split, [k]).motion("carriage", "load") for k in (0, len(split.fitted))]
    expected = any(abs(load[0]) >= 0.5 * np.sqrt(np.mean(load**2)) for load in loads)
    assert bool(memory_begins_empty([_accepted(REMEMBERS)], final, split)) is expected


def test_a_law_without_that_memory_is_not(traced):
    others = [_accepted(effect_named("dahl")), _accepted(law("modulus_of_load_times_sign_of_velocity"))]
    assert memory_begins_empty(others, *traced) == ""
