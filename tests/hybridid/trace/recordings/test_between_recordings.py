"""Recordings that differ in a parameter, beside what the search finds in them. All are simulated."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from hybridid.trace.recordings.between_recordings import _may_differ_by_recording
from hybridid.trace.run import trace
from hybridid.trace.search.steps import RECORDINGS_DIFFER

NOISE = 2e-6  # m
SAID = "The recordings disagree: if each has its own "


@pytest.fixture(scope="module")
def traced(make_model, carriage_like, noise):
    """The trace of two runs, the second of a carriage with another ``truth`` than that of the first."""

    def of(first, second, *effects, **asked):
        runs = [
            carriage_like(**truth).record(noise=noise(600, NOISE, seed=4 + k), name=f"run {k}")
            for k, truth in enumerate((first, second))
        ]
        only = {"laws": False, "pairs": 0, "variables": ("velocity",)}
        return trace(make_model(), runs, effects=effects, **only, **asked)

    return of


def test_a_load_that_differs_is_told_before_all_else_and_ends_the_search(traced):
    found = traced({"M": 95.0}, {"M": 125.0}, "quadratic_drag", "input_gain")
    assert found.sentence.startswith(f"{SAID}M, the model leaves ")
    assert "M is 95 kg in run 0 and 125" in found.sentence
    assert "parameters.M.by=record" in found.sentence
    assert found.verdict == "unexplained"
    assert len(found.steps) == 1
    assert found.stopped == RECORDINGS_DIFFER
    assert "trace.by_recording=false searches on" in found.sentence


def test_who_knows_that_nothing_differs_gets_the_whole_search(traced):
    found = traced({"M": 95.0}, {"M": 125.0}, "quadratic_drag", "input_gain", recordings=False)
    assert found.sentence.startswith(SAID)
    assert found.stopped != RECORDINGS_DIFFER
    assert found.verdict == ("ambiguous" if found.accepted else "unexplained")
    assert bool(found.accepted) == ("which may only stand for it" in found.sentence)


def test_what_is_missing_in_both_is_named_without_that(traced):
    found = traced({"df_v": 80.0}, {"df_v": 80.0}, "asymmetric_viscous", "quadratic_drag")
    assert found.verdict == "effect_found"
    assert found.disagreement == ""


def test_a_search_that_a_time_limit_cut_stays_open(make_model, carriage_like, noise):
    """Its names may change, whatever differs between the recordings."""
    runs = [
        carriage_like(M=mass).record(noise=noise(600, NOISE, seed=4 + k), name=f"run {k}")
        for k, mass in enumerate((95.0, 125.0))
    ]
    only = {"laws": False, "pairs": 0, "variables": ("velocity",), "time_limit": 0.0}
    found = trace(make_model(("viscous",)), runs, effects=["coulomb", "offset"], **only)
    assert found.accepted
    assert found.verdict == "undecided"


def test_what_is_missing_in_one_alone_is_left_open(traced):
    """It looks like another parameter there, and no effect has one amount in both."""
    found = traced({}, {"df_v": 80.0}, "asymmetric_viscous")
    assert found.sentence.startswith(SAID)
    assert "else the model lacks what makes it differ" in found.sentence
    assert found.verdict == "unexplained"


def test_where_an_amplitude_is_no_constant_the_recordings_may_differ():
    refused = "spring.offset may stand in for something else: its amplitude is no constant: 2 N, then 3 N"
    named = [SimpleNamespace(name=name, digest="") for name in ("up", "down")]
    parts = [SimpleNamespace(name=name, digest="1f0a") for name in ("fitted", "judging")]
    two, one, of_one = (SimpleNamespace(split=SimpleNamespace(records=n)) for n in (named, named[:1], parts))
    withdrawn, kept = (SimpleNamespace(withdrawn=why, steps=()) for why in (refused, ""))
    assert _may_differ_by_recording(withdrawn, two).endswith("trace.held_out=null.")
    assert _may_differ_by_recording(withdrawn, one) == _may_differ_by_recording(kept, two) == ""
    assert _may_differ_by_recording(withdrawn, of_one) == "", "two parts of one file are one recording"
    step = SimpleNamespace(trials=[SimpleNamespace(reason=refused)])
    assert _may_differ_by_recording(SimpleNamespace(withdrawn="", steps=[step]), two)
