"""The figure of a model in the loop: each signal beside the recorded one, and its error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.plotting.loop import loop_plot
from hybridid.plotting.series import PlotError


def test_each_signal_has_a_panel_of_its_own_and_one_of_its_error(responses):
    model = responses[0]
    force = replace(
        model, output="force", unit="N", measured=1e3 * model.measured, predicted=0.9e3 * model.measured
    )
    axes = loop_plot([[model], [force]]).figure.axes
    assert [one.get_ylabel() for one in axes] == ["position [mm]", "error [mm]", "force [N]", "error [N]"]
    error = axes[3].get_lines()[0].get_ydata()
    assert np.abs(error).max() == pytest.approx(np.abs(0.1e3 * model.measured).max(), rel=1e-6)
    assert np.isclose(axes[0].get_xlim()[1], axes[3].get_xlim()[1])


def test_a_model_that_leaves_the_axis_is_labelled(responses):
    runaway = replace(responses[0], predicted=10 * responses[0].measured + 5)
    legend = loop_plot([[responses[0], runaway]]).figure.axes[0].get_legend()
    assert sum("(leaves the axis)" in text.get_text() for text in legend.get_texts()) == 1


def test_nothing_to_draw_is_refused(responses):
    with pytest.raises(PlotError, match="no signal in the loop"):
        loop_plot([])
    other = replace(responses[1], output="force", unit="N")
    with pytest.raises(PlotError, match="cannot draw output"):
        loop_plot([[responses[0], other]])
