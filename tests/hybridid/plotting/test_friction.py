"""Friction over velocity: totals on the data, effects beside them."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.declarations import Port
from hybridid.plotting.friction import FrictionCurve, friction_plot
from hybridid.plotting.series import PlotError


def plot_of(port, curves, data=None):
    return friction_plot(port, curves, "identification", "measured", data)


def test_the_total_is_the_sum_of_the_effects(port, curves):
    overview, first, second = plot_of(port, curves).figure.axes
    velocity = curves[1].over
    total = 200 * velocity + 20 * np.tanh(velocity / 1e-3) - 3 - 35 * np.abs(velocity)
    assert overview.get_lines()[1].get_ydata() == pytest.approx(total)
    assert second.get_lines()[0].get_ydata() == pytest.approx(total)
    assert (len(first.get_lines()), len(second.get_lines())) == (4 + 2, 5 + 2)  # with the cross of the axes
    assert overview.get_xlabel() == "velocity of carriage [mm/s]"
    assert overview.get_ylabel() == "resisting effort [N]"


def test_an_effect_looks_the_same_in_every_panel_and_like_no_model(port, curves):
    _, first, second = plot_of(port, curves).figure.axes

    def looks(axes):
        return [
            (line.get_label(), line.get_color()) for line in axes.get_lines() if line.get_label()[0] != "_"
        ]

    assert looks(first)[1:] == looks(second)[1:4]  # after the model's total: viscous, coulomb, offset
    assert len({colour for _, colour in looks(second)}) == 5


def test_a_model_named_like_an_effect_keeps_both_in_the_legend(port, curves):
    texts = [t.get_text() for t in plot_of(port, curves).figure.legends[0].get_texts()]
    assert "asymmetric viscous, total" in texts
    assert "asymmetric viscous" in texts


def test_the_data_s_medians_lie_on_the_law_that_made_them(port, curves, friction_data):
    overview = plot_of(port, curves, friction_data).figure.axes[0]
    (bars,) = overview.containers
    velocity, effort = np.array(bars.lines[0].get_data())
    assert len(velocity) >= 20
    away = np.abs(velocity) > 10  # mm/s: a bin across zero holds both signs of Coulomb friction
    law = 0.2 * velocity + 20 * np.sign(velocity) - 3
    assert effort[away] == pytest.approx(law[away], abs=1.0)


def test_wild_samples_do_not_set_the_limits(port, curves, friction_data):
    effort = friction_data.effort.copy()
    effort[::500] = 1e4
    low, high = (
        plot_of(port, curves, type(friction_data)(friction_data.over, effort)).figure.axes[0].get_ylim()
    )
    assert low > -100
    assert high < 100


def test_too_few_data_for_bins_are_still_drawn(port, curves, friction_data):
    few = type(friction_data)(friction_data.over[:30], friction_data.effort[:30])
    overview = plot_of(port, curves, few).figure.axes[0]
    assert len(overview.get_lines()[0].get_xdata()) == 30


def test_bad_input_is_said(port):
    with pytest.raises(PlotError, match="friction at carriage: no model's curve"):
        plot_of(port, [])
    with pytest.raises(PlotError, match="effect viscous has 2 efforts for 3 velocities"):
        FrictionCurve("m", np.arange(3.0), {"viscous": np.zeros(2)})


def test_at_a_level_flows_are_drawn_over_the_level():
    tank = Port("upper", "flow", "m³/s", 1e-3, "m", 0.3, velocity_scale=0.05)
    level = np.linspace(0.1, 0.6, 50)
    plot = friction_plot(
        tank, [FrictionCurve("m", level, {"linear_leak": 1e-3 * level})], "filling", "measured"
    )
    overview = plot.figure.axes[0]
    assert overview.get_xlabel() == "level of upper [mm]"
    assert overview.get_ylabel().startswith("flow that leaves [")
    assert plot.caption.startswith(
        "Flow that leaves upper over its level, total and by effect, for m on filling"
    )
