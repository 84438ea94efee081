"""Amplitude spectra against what is known of a sine and of white noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.plotting.series import PlotError, Response
from hybridid.plotting.spectrum import spectrum_plot


def response_of(measured, predicted, dt=1e-3):
    return Response("model", "record", "position", "m", np.arange(len(measured)) * dt, measured, predicted)


def line(axes, index):
    x, y = axes.get_lines()[index].get_data()
    return np.asarray(x), np.asarray(y)


def test_white_noise_has_the_density_of_its_variance():
    noise = 1e-3 * np.random.default_rng(0).standard_normal(40_000)
    output, error = spectrum_plot([response_of(noise, np.zeros_like(noise))]).figure.axes
    assert output.get_ylabel().replace("\n", " ") == "amplitude density [µm/√Hz]"
    frequency, density = line(error, 1)
    expected = 1e-3 / np.sqrt(500.0) * 1e6  # sigma over the root of half the sampling frequency
    middle = (frequency > 20) & (frequency < 400)
    assert density[middle] == pytest.approx(np.full(middle.sum(), expected), rel=0.15)


def test_a_sine_of_the_error_stands_at_its_frequency(responses):
    base = responses[0]
    hum = 1e-3 * np.sin(2 * np.pi * 50 * base.time)
    _, error = spectrum_plot([replace(base, predicted=base.measured - hum)]).figure.axes
    frequency, density = line(error, 1)
    assert frequency[density.argmax()] == pytest.approx(50, rel=0.03)


def test_low_frequencies_keep_their_own_lines(responses):
    frequency, _ = line(spectrum_plot(responses[:1]).figure.axes[0], 0)
    assert frequency[:4] == pytest.approx(frequency[0] * np.arange(1, 5))
    assert len(frequency) < 200


def test_the_output_panel_has_data_and_models_and_the_error_panel_their_errors(responses):
    figure = spectrum_plot(responses[:2]).figure
    assert [len(axes.get_lines()) for axes in figure.axes] == [3, 3]
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["output", "error"]
    assert figure.axes[0].get_xscale() == figure.axes[0].get_yscale() == "log"


def test_a_perfect_model_does_not_break_the_axis(responses):
    perfect = replace(responses[0], predicted=responses[0].measured)
    low, high = spectrum_plot([perfect]).figure.axes[0].get_ylim()
    assert 0 < low < high


def test_bad_input_is_said(responses):
    with pytest.raises(PlotError, match="10 samples, at least 64"):
        spectrum_plot([response_of(np.zeros(10), np.zeros(10))])
    diverged = replace(responses[0], predicted=np.full_like(responses[0].time, np.inf))
    with pytest.raises(PlotError, match="not finite"):
        spectrum_plot([diverged])
