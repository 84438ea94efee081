"""What records do not tell is told. All records here are simulated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hybridid.advice.untold import judged_by_itself, left_open
from hybridid.estimators import FitSettings, fit
from hybridid.quality import judge


def test_a_mass_that_the_record_leaves_open_is_told(make_model, carriage):
    """Over 20 ms, beside noise of a millimetre, the mass shows nothing."""
    noise = np.random.default_rng(0).normal(0, 1e-3, 600)
    record = carriage.record(noise=noise)
    estimate = fit(make_model(), [record], FitSettings(horizon=4))
    (mass,) = (one for one in estimate.parameters if one.name == "M")
    said = [one.said for one in left_open(estimate)]
    assert (mass.std > mass.value) == any(one.startswith("M is ") for one in said)
    assert mass.std > mass.value
    assert "parameters.M.fixed=..." in said[0]


def test_a_mass_that_the_record_tells_is_not_told(make_model, carriage):
    assert list(left_open(fit(make_model(), [carriage.record()]))) == []


def test_a_record_that_judges_the_fit_to_itself_is_told(make_model, carriage):
    record = carriage.record()
    copy, other = replace(record, name="copy"), carriage.record(n=500)
    (one,) = judged_by_itself([record], [copy, other, record])
    assert one.said.startswith("record copy holds the samples of")
    estimate = fit(make_model(), [record])
    assert one in judge(make_model(), [record], estimate, [copy]).advice
