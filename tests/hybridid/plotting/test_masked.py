"""Figures of masked records: the stretches that do not count are shaded, and no line runs across them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.plotting.comparison import comparison_plot
from hybridid.plotting.error import error_plot
from hybridid.plotting.record import record_plot
from hybridid.plotting.series import Response
from hybridid.plotting.spectrum import amplitude_density, spectrum_plot
from hybridid.signals.masks import Mask
from hybridid.validation import Prediction
from pipelines.shared.predictions import read_prediction, write_prediction

HOLES = [(5.0, 6.0), (12.0, 20.0)]


@pytest.fixture
def masked(record):
    return Mask(stretches=tuple(HOLES)).apply(record)


@pytest.fixture
def seen(masked):
    """A prediction of the masked record over horizons of 4 s."""
    rows = np.flatnonzero(masked.counts)
    measured = masked.outputs[rows]
    return Prediction(
        record=masked.name,
        view="horizon",
        provenance="measured",
        time=masked.time[rows],
        measured=measured,
        predicted=measured + 1e-3,
        states=np.zeros((len(rows), 1)),
        output_names=("position",),
        output_units=("m",),
        state_names=("q",),
        breaks=(0, 4000, 8000, 20000),
        initial_states=np.zeros((4, 1)),
        rows=rows,
    )


def shaded(axes):
    return [(p.get_x(), p.get_x() + p.get_width()) for p in axes.patches if p.get_gid() == "masked"]


def test_the_record_is_drawn_whole_with_its_masked_parts_shaded(masked, record):
    for axes in record_plot(masked).figure.axes:
        np.testing.assert_allclose(shaded(axes), HOLES, atol=2e-3)
        assert np.isfinite(axes.get_lines()[0].get_ydata()).all()
    assert "9,000 of them masked (shaded)" in record_plot(masked).caption
    assert "masked" not in record_plot(record).caption


@pytest.mark.parametrize("draw", [comparison_plot, error_plot])
def test_lines_stop_where_nothing_counts(draw, seen):
    response = Response.of("gray box", seen)
    plot = draw([response])
    axes = plot.figure.axes[0]
    np.testing.assert_allclose(shaded(axes), HOLES, atol=2e-3)
    for line in axes.get_lines():
        x, y = np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float)
        if len(x) > 10:
            jumps = np.flatnonzero(np.diff(x[np.isfinite(y)]) > 0.5)
            assert len(jumps) == 2
            for start, stop in HOLES:
                assert np.isnan(y[np.searchsorted(x, stop - 0.1) : np.searchsorted(x, stop + 0.1)]).any(), (
                    start
                )
    assert plot.caption.endswith("shaded: masked, does not count.")
    whole = replace(response, holes=np.empty((0, 2)))
    assert not shaded(draw([whole]).figure.axes[0])


def test_horizons_start_where_they_did(seen, masked):
    np.testing.assert_array_equal(Response.of("gray box", seen).starts, masked.time[list(seen.breaks)])


def test_a_spectrum_is_that_of_the_longest_part(seen):
    response = Response.of("gray box", seen)
    longest = slice(5000, 11000)
    expected = amplitude_density(response.time[longest], response.measured[longest], "data")
    line = spectrum_plot([response]).figure.axes[0].get_lines()[0]
    np.testing.assert_allclose(line.get_xdata(), expected[0])
    assert "longest part without mask" in spectrum_plot([response]).caption


def test_a_file_keeps_which_samples_it_shows(seen, tmp_path):
    stored = read_prediction(write_prediction(tmp_path, seen, "gray box", 4.0)).prediction
    np.testing.assert_array_equal(stored.rows, seen.rows)
    np.testing.assert_array_equal(stored.starts, seen.starts)
    plain = replace(seen, rows=None)
    assert read_prediction(write_prediction(tmp_path, plain, "gray box", 4.0)).prediction.rows is None
