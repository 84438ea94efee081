"""Advice from config to terminal: kept with the verdict, printed once; a wrong horizon stops it early."""

from __future__ import annotations

import json

import numpy as np
import pytest

from hybridid_cli.results import summary
from pipelines.runner import run_stages
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import fit_of


def test_advice_is_kept_and_printed_and_changes_no_verdict(settings, data, heard, fits_schema):
    plain = run_stages(settings({"estimator.horizon": None}), "fit", heard)
    told = run_stages(settings({"estimator.horizon": 900}), "fit", heard)
    quality = fit_of(told.tree).quality
    (one,) = [advice for advice in quality.advice if advice.kind == "horizon"]
    assert one.said.startswith("estimator.horizon=900 is 0.9 s, longer than a tenth of all that is fitted")
    assert summary(told, "fit").count(one.said) == 1
    assert [a.kind for a in fit_of(plain.tree).quality.advice if a.kind == "horizon"] == []
    assert quality.verdict == fit_of(plain.tree).quality.verdict
    fits_schema(told.tree / "fit" / "estimate.json")


def test_records_that_are_not_fitted_are_those_whose_range_is_looked_at(settings, data, heard):
    """The second record has pulses on its force."""
    found = run_stages(settings(), "fit", heard)
    said = [a.said for a in fit_of(found.tree).quality.advice if a.kind == "range"]
    assert len(said) == 1
    assert said[0].startswith("record second leaves what was fitted: force ")
    both = run_stages(settings({"fit.records": None}), "fit", heard)
    assert [a for a in fit_of(both.tree).quality.advice if a.kind == "range"] == []


def test_a_result_of_before_there_was_advice_is_read(settings, data, heard):
    found = run_stages(settings(), "fit", heard)
    path = found.tree / "fit" / "estimate.json"
    content = json.loads(path.read_text())
    del content["quality"]["advice"]
    path.write_text(json.dumps(content))
    assert fit_of(found.tree).quality.advice == ()


@pytest.fixture
def slow(settings, own_folder):
    """The short case sampled once a second."""
    folder = own_folder / "data"
    folder.mkdir()
    time = np.arange(600.0)
    for name in ("first.csv", "second.csv"):
        columns = np.column_stack([time, np.sin(time / 9), np.cos(time / 9)])
        np.savetxt(folder / name, columns, delimiter=",", header="t,force,mm", comments="")
    return settings


def test_a_horizon_of_a_second_is_refused_before_the_fit_where_sampling_is_slow(slow, heard):
    with pytest.raises(ConfigError) as caught:
        run_stages(slow({"validate.horizon": 1.0}), "run", heard)
    assert str(caught.value) == (
        "validate.horizon is 1 s: record first is sampled every 1 s, a horizon needs at least 2 samples; "
        "validate.horizon=50 is proposed"
    )
    assert not any(line.startswith("fit") for line in heard.said)


def test_a_trace_over_such_horizons_is_refused_before_the_fit(slow, heard):
    with pytest.raises(ConfigError) as caught:
        run_stages(slow({"trace": {"held_out": None, "horizon": 1.0}}), "trace", heard)
    assert str(caught.value) == (
        "trace.horizon is 1 s: record first is sampled every 1 s, a horizon needs at least 2 samples; "
        "trace.horizon=30 is proposed"
    )
    assert not any(line.startswith("fit") for line in heard.said)


def test_views_without_horizons_ask_for_none(slow, heard):
    run_stages(slow({"validate.horizon": 1.0}), "preprocess", heard)
    views = slow({"validate.horizon": 1.0, "validate.views": ["free_run"]})
    assert "validate" in run_stages(views, "validate", heard).ran
