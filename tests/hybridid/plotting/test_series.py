"""Responses: made from predictions, checked when they are drawn together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.plotting.series import PlotError, Response, one_output


def test_a_free_run_has_no_starts(record, predict):
    response = Response.of("symmetric", predict(record), "position")
    assert (response.view, len(response.starts)) == ("free run", 0)
    assert (response.output, response.unit, response.provenance) == ("position", "m", "measured")
    assert response.rmse == pytest.approx(float(np.sqrt(np.mean(predict(record).error ** 2))))


def test_horizons_say_how_long_they_are_and_where_they_start(record, predict):
    response = Response.of("symmetric", predict(record, "horizon"))
    assert response.view == "horizons of 1 s"
    assert response.starts == pytest.approx(np.arange(25.0))


def test_an_unknown_output_gets_the_nearest_name(record, predict):
    with pytest.raises(PlotError, match="no output 'positon' to plot; nearest 'position'"):
        Response.of("symmetric", predict(record), "positon")


def test_lengths_must_agree():
    with pytest.raises(PlotError, match="3, 3 and 2 samples"):
        Response("a", "r", "q", "m", np.arange(3.0), np.zeros(3), np.zeros(2))


def test_only_one_output_of_one_record_is_drawn_together(responses):
    first = responses[0]
    with pytest.raises(PlotError, match="at least one"):
        one_output([])
    with pytest.raises(PlotError, match=r"output force \[N\] together with position \[m\]"):
        one_output([first, replace(first, output="force", unit="N")])
    with pytest.raises(PlotError, match="record validation together with identification"):
        one_output([first, replace(first, record="validation")])
    assert one_output([first, replace(first, record="validation")], one_record=False) is first
