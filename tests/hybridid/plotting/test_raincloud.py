"""Rainclouds: quantiles, errors and names of each row."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.plotting.raincloud import _density, raincloud_plot
from hybridid.plotting.series import PlotError


def test_boxes_are_the_quantiles_of_the_errors(responses):
    axes = raincloud_plot(responses[:1]).figure.axes[0]
    box = next(p for p in axes.patches if len(p.get_path().vertices) >= 5)
    edges = box.get_path().vertices[:, 0]
    quartiles = np.quantile(1e3 * responses[0].error, (0.25, 0.75))
    assert (edges.min(), edges.max()) == pytest.approx(tuple(quartiles))


def test_each_row_has_its_name_and_its_rmse(responses):
    axes = raincloud_plot(responses).figure.axes[0]
    names = [label.get_text() for label in axes.get_yticklabels()]
    assert names[0] == "symmetric friction\nfree run\nidentification"
    assert names[3] == "asymmetric viscous\nhorizons of 1 s\nidentification"
    (right,) = axes.child_axes
    values = [label.get_text() for label in right.get_yticklabels()]
    assert values[0] == f"RMSE\n{1e3 * responses[0].rmse:.3g} mm"


def test_the_density_lies_where_the_errors_are(responses):
    axes = raincloud_plot(responses[:1]).figure.axes[0]
    outline = next(line for line in axes.get_lines() if len(line.get_xdata()) == 240)
    x, y = outline.get_data()
    error = 1e3 * responses[0].error
    inside = (error > x[y.argmax()] - 0.3) & (error < x[y.argmax()] + 0.3)
    assert inside.mean() > 2 * 0.6 / np.ptp(error)


def test_the_density_is_that_of_a_kernel_at_every_sample():
    from scipy.stats import gaussian_kde

    values = np.random.default_rng(0).gamma(2.0, size=2000)
    grid, height = _density(values)
    expected = gaussian_kde(values)(grid)
    assert height / height.max() == pytest.approx(expected / expected.max(), abs=0.01)


def test_one_simulated_record_marks_the_figure(responses):
    rig = replace(responses[0], record="a rig", provenance="simulated")
    plot = raincloud_plot([responses[0], rig])
    assert plot.provenance == "measured and simulated"
    assert plot.figure.findobj(lambda artist: artist.get_gid() == "provenance")
    assert "a rig (simulated)" in plot.figure.axes[0].get_yticklabels()[1].get_text()


def test_errors_that_are_all_equal_still_make_a_figure(responses):
    constant = replace(responses[0], predicted=responses[0].measured - 0.5)
    assert raincloud_plot([constant]).figure.axes[0].get_xlabel() == "position error [mm]"


def test_errors_that_are_not_finite_are_refused(responses):
    diverged = replace(responses[0], predicted=np.full_like(responses[0].time, np.nan))
    with pytest.raises(PlotError, match="errors of symmetric friction on identification are not finite"):
        raincloud_plot([diverged])


def test_long_names_keep_the_end_that_tells_them_apart(responses):
    named = [
        replace(responses[0], model=f"viscous + coulomb + offset + stribeck number {k}") for k in range(2)
    ]
    labels = [label.get_text() for label in raincloud_plot(named).figure.axes[0].get_yticklabels()]
    assert labels[0] != labels[1]
    assert max(len(line) for label in labels for line in label.split("\n")) <= 30
