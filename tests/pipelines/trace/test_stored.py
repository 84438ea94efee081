"""``trace.json``: what is written reads back, and the terminal prints it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from hybridid.advice.advice import Advice
from hybridid.estimators import Estimate, FitSettings
from hybridid.plain import plain
from hybridid.quality import Finding, Quality
from hybridid_cli.tables import rendered
from hybridid_cli.trace_results import trace_results
from pipelines.shared.fitted import ESTIMATE, Fit
from pipelines.shared.storage import read_json, write_json
from pipelines.shared.traced import TRACE, trace_of


@pytest.fixture
def tree(stored, tmp_path) -> Path:
    (tmp_path / TRACE).parent.mkdir()
    write_json(tmp_path / TRACE, stored())
    return tmp_path


def test_it_reads_back(stored, tree):
    assert plain(trace_of(tree)) == plain(stored())


def test_what_is_not_finite_is_null_and_keys_are_flat(tree):
    data = json.loads((tree / TRACE).read_text())
    assert data["after"][0]["rmse"] is None
    assert data["accepted"][0]["class"] == ["coulomb", "dahl"]
    assert data["case"] == "cart"


def test_models_are_not_stored(tree):
    with pytest.raises(ValueError, match="read from a file"):
        _ = trace_of(tree).found.model


def test_the_terminal_prints_it(tree):
    text = rendered(trace_results(tree))
    for part in (
        "ambiguous: The model lacked a friction.\n- Beware: it may be another one.\n- Free runs",
        "f_c = 2.000 ± 0.098 N", "1 of 2 agree", "diverges",
        "simulated", "tried 3 effects in 1 step,", "go on:  hybridid run case=cart", "horizons that judge",
    ):  # fmt: skip
        assert part in text, part


def test_the_terminal_names_the_file_of_a_proposed_law(tree):
    assert "law:" not in rendered(trace_results(tree))
    file = (tree / TRACE).parent / "proposed_law.py"
    file.write_text("")
    assert f"law:    {file}" in rendered(trace_results(tree)).replace("\n", "")


def test_the_errors_of_a_model_that_the_trace_left_as_it_was_stand_once(stored, tree):
    assert "RMSE before" in rendered(trace_results(tree))
    write_json(tree / TRACE, stored(accepted=()))
    said = rendered(trace_results(tree))
    assert "The model's errors" in said
    assert "before" not in said[said.index("The model's errors") :].split("\n\n")[0]


def test_the_terminal_repeats_what_the_fit_advises(tree):
    """But not how long the horizons of the fit should be: a trace has its own."""
    nothing, advice = np.zeros((0, 0)), Advice("decay", "amplitude and time go hand in hand")
    beyond = Advice("range", "record b leaves what was fitted")
    horizon = Advice("horizon", "horizons of 12 s would show more")
    blurred = Advice("smoothing", "sign(v) is smoothed so widely")
    estimate = Estimate(
        (), {}, nothing, nothing, (), 1.0, "converged", converged=True, iterations=3, seconds={},
        substeps=1, settings=FitSettings(),
    )  # fmt: skip
    findings = (Finding("bound", "k wants to leave its bounds"), Finding("step", "steps are too long"))
    quality = Quality("wrong", "wrong", findings, (), 0.0, advice=(advice, beyond, horizon, blurred))
    (tree / ESTIMATE).parent.mkdir()
    write_json(tree / ESTIMATE, Fit("cart", "gray box", ("push",), "simulated", (), quality, estimate))
    said = rendered(trace_results(tree))
    assert "advice of the fit of the declared model: amplitude and time" in said
    assert "beware, by the fit of the declared model: k wants to leave its bounds" in said
    assert "steps are too long" not in said
    assert "b leaves what was fitted" in said
    assert "horizons of 12 s" not in said
    assert "smoothed so widely" in said
    stored = read_json(tree / TRACE)
    width = {"name": "cart.epsilon", "unit": "m/s", "declared": 1e-3, "used": 5e-4}
    write_json(tree / TRACE, {**stored, "narrowed": [width]})
    assert "smoothed so widely" not in rendered(trace_results(tree)), "the trace smoothed it less"
    write_json(tree / TRACE, {**stored, "records": [{**one, "role": "fitted"} for one in stored["records"]]})
    assert "leaves what was fitted" not in rendered(trace_results(tree)), "the trace fits them all"
