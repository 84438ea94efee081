"""Steps that leave an error at an edge are made shorter before anything is named."""

from dataclasses import replace

import pytest

from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit
from hybridid.trace.search import finer_steps
from hybridid.trace.search.finer_steps import in_short_steps
from hybridid.trace.trials.robustness import variations
from hybridid.trace.words.remarks import finer_in_words

WALL, HARDNESS = 0.0218, 3e5  # m, N/m
ENDED = ("viscous", "coulomb", "offset", "end_stop")
NEAR = {"carriage.end_stop.k": HARDNESS, "carriage.end_stop.d": WALL, "carriage.end_stop.tau": 0.0}


@pytest.fixture(scope="module")
def stopped(split_of):
    """A carriage that runs against a stop within a step, its sensor finer than that step."""
    return split_of(std=1e-7, wall=WALL, hardness=HARDNESS)


def test_steps_are_halved_until_that_gains_nothing(make_model, stopped):
    base = refit(make_model(ENDED), stopped, [NEAR])
    said = []
    found = in_short_steps(base, Context(stopped, say=said.append))
    assert (base.substeps, found.substeps, found.numerics.finer) == (1, 2, 2)
    assert base.score.rmse[0] > 1.2e-7
    assert found.score.rmse[0] == pytest.approx(1e-7, rel=0.05), "the sensor's noise alone is left"
    assert said == ["the integrator takes 2 steps a sample from here on: that leaves less error"]
    finer = [one.finer for one in variations(stopped.records, found.numerics) if one.name == "half the step"]
    assert finer == [4], "half of the step in use"


def test_steps_that_leave_nothing_stay_and_nothing_is_refitted(make_model, split_of, monkeypatch):
    split = split_of()
    base = refit(make_model(), split)
    monkeypatch.setattr(finer_steps, "_in_half_the_step", None)
    assert in_short_steps(base, Context(split)) is base


def test_shorter_steps_are_told(nothing):
    said = finer_in_words(replace(nothing(), finer=4))
    assert said.startswith("The integrator takes 4 times as many steps a sample as smooth motion asks for: ")
    assert finer_in_words(nothing()) == ""
