"""Legends keep inside the figure and off the data, however many and long their entries."""

from __future__ import annotations

import pytest

from hybridid.plotting.legends import legend_above, legend_on_top
from hybridid.plotting.style import HEADER, MM_PER_INCH, context, new_figure

LONG = "a very long name of a model " * 6


def on_top(figure, axes, handles):
    legend_on_top(figure, handles)


def above(figure, axes, handles):
    legend_above(axes, "free run")


def legend_of(labels, place):
    with context():
        figure = new_figure(88, 60, "a", "simulated")
        axes = figure.subplots()
        handles = [axes.plot([0, 1], [0, k], label=label)[0] for k, label in enumerate(labels)]
        place(figure, axes, handles)
        figure.draw_without_rendering()
        return axes.get_legend() or figure.legends[0], figure, axes


def header_of(figure):
    return figure.findobj(lambda artist: artist.get_gid() == "heading")[0].get_window_extent()


@pytest.mark.parametrize("place", [on_top, above])
@pytest.mark.parametrize("labels", [["short"], ["name"] * 9, [LONG] * 3])
def test_legends_lie_between_the_heading_and_the_axes(labels, place):
    legend, figure, axes = legend_of(labels, place)
    box = legend.get_window_extent()
    assert len(legend.get_texts()) == len(labels)
    assert box.x0 >= -1
    assert box.x1 <= figure.bbox.x1 + 1
    assert axes.get_window_extent().y1 - 1 <= box.y0
    assert box.y1 <= header_of(figure).y0 + 1


@pytest.mark.parametrize("place", [on_top, above])
def test_the_figure_grows_with_its_legend_and_the_panels_keep_their_size(place):
    (_, small, axes), (_, large, same) = legend_of(["one"], place), legend_of([LONG] * 8, place)
    assert large.get_figheight() > small.get_figheight() + 0.5
    assert same.get_window_extent().height == pytest.approx(axes.get_window_extent().height, rel=0.05)
    below_edge = large.bbox.y1 - header_of(large).y0
    assert below_edge < HEADER / MM_PER_INCH * large.dpi


def test_short_labels_share_a_row():
    legend, _, _ = legend_of(["one", "two", "three"], on_top)
    assert len({round(text.get_window_extent().y0) for text in legend.get_texts()}) == 1


@pytest.mark.parametrize("place", [on_top, above])
def test_a_long_name_is_cut_but_not_what_is_said_of_it(place):
    legend, _, _ = legend_of(
        [f"{LONG.strip()}, free run: RMSE 2.6 mm", "other, free run: RMSE 1.2 mm"], place
    )
    cut, whole = (text.get_text() for text in legend.get_texts())
    assert "…" in cut
    assert cut.endswith("el, free run: RMSE 2.6 mm")
    assert whole == "other, free run: RMSE 1.2 mm"
