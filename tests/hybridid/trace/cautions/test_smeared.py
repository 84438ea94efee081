"""An error that the smoothing of sign(v) makes is told beside what is unexplained. All simulated."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.trace.cautions.smeared import smoothing_may_be_all
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit


@pytest.fixture(scope="module")
def split(split_of):
    return split_of()


def smoothed(make_model, split, times):
    """The declared model, fitted with sign(v) smoothed so many times as widely as the truth."""
    width = make_model().adjustments["carriage.epsilon"]["guess"]
    return refit(make_model(adjust={"carriage.epsilon": {"guess": times * width}}), split)


def test_a_smoothing_that_makes_most_of_the_error_is_told(make_model, split):
    said = smoothing_may_be_all(smoothed(make_model, split, 4.0), Context(split))
    assert said.startswith(" Beware: on the fitted horizons the smoothing of sign(v) leaves to first order ")
    assert " of position (" in said
    assert said.endswith("A smaller carriage.epsilon or shorter horizons tell.")


def test_one_that_makes_little_of_it_is_not(make_model, split):
    base = smoothed(make_model, split, 1.0)
    far = replace(base, fitted_rmse=1e3 * base.fitted_rmse)
    assert smoothing_may_be_all(far, Context(split)) == ""


def test_without_dry_friction_there_is_none(make_model, split):
    bare = refit(make_model(("viscous",)), split)
    unsmoothed = replace(bare, model=replace(bare.model, terms=()), values={"M": 95.0})
    assert smoothing_may_be_all(unsmoothed, Context(split)) == ""
