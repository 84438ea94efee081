"""The heat map: what is darker, framed, written."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.patches import Rectangle

from hybridid.plotting.heat_map import Cells, heat_map_plot
from hybridid.plotting.series import PlotError


def drawn(values, spread=None, chosen=None, panels=1):
    values = np.asarray(values, float)
    spread = np.full(values.shape, np.nan) if spread is None else np.asarray(spread, float)
    rows, columns = (list(map(str, range(n))) for n in values.shape)
    cells = [Cells(f"orders {k}", values, spread, chosen) for k in range(panels)]
    of = ("layers [–]", rows), ("neurons a layer [–]", columns)
    return heat_map_plot(cells, *of, ("held-out RMSE", "m"), "position", "simulated")


def test_numbers_are_written_with_their_spread_in_a_readable_unit():
    plot = drawn([[2e-3, 3e-3]], [[1e-4, np.nan]])
    written = [text.get_text() for text in plot.figure.axes[0].texts]
    assert written == ["2\n± 0.1", "3"]
    assert plot.caption == (
        "Held-out RMSE in mm over layers and neurons a layer (simulated), mean ± standard deviation over "
        "seeds where there are several."
    )


def test_the_chosen_cell_is_framed_and_a_missing_one_says_so():
    plot = drawn([[1.0, np.nan], [3.0, 4.0]], chosen=(1, 0))
    axes = plot.figure.axes[0]
    (frame,) = [patch for patch in axes.patches if isinstance(patch, Rectangle)]
    centre = frame.get_x() + frame.get_width() / 2, frame.get_y() + frame.get_height() / 2
    assert centre == pytest.approx((0, 1))
    assert [text.get_text() for text in axes.texts][1] == "–"
    assert plot.caption.endswith("(simulated); framed: chosen.")


def test_colours_go_by_decades_where_the_numbers_do():
    near, far = drawn([[1.0, 2.0]]), drawn([[1.0, 1000.0]])
    middle = [plot.figure.axes[0].images[0].norm(10.0) for plot in (near, far)]
    assert middle[1] == pytest.approx(1 / 3)
    assert middle[0] > 1


def test_many_panels_are_cut_and_the_caption_says_so():
    assert "12 panels of 20" in drawn([[1.0, 2.0]], panels=20).caption


def test_nothing_to_show_is_refused():
    with pytest.raises(PlotError, match="no finite number"):
        drawn([[np.nan]])
