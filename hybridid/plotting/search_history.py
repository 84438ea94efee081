"""Figure: the held-out error of every trial of a search, and the lowest so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from hybridid.plotting.legends import legend_above
from hybridid.plotting.looks import BLUE, INK, SOFT_INK, VERMILION
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled

_HIGHEST = 150.0
"""Largest error in per cent that is shown; a network with more is irrelevant to the choice."""


@dataclass(frozen=True)
class Tried:
    """A trial and its error; a ``pruned`` trial has its last error before it was stopped."""

    number: int
    share: float
    pruned: bool
    chosen: bool


@styled
def history_plot(tried: Sequence[Tried], title: str, provenance: str, width: float = DOUBLE_COLUMN) -> Plot:
    """A dot for each trial, a cross if it was pruned, a step line at the lowest so far, a ring at the choice.

    Raises:
        PlotError: if there is no trial with a finite error.
    """
    shown = [one for one in tried if np.isfinite(one.share)]
    if not shown:
        raise PlotError("search history: no trial has an error")
    figure = new_figure(width, 70, title, provenance)
    axes = figure.subplots()
    for pruned, mark, color, name in ((False, "o", BLUE, "to its end"), (True, "x", SOFT_INK, "pruned")):
        own = [one for one in shown if one.pruned is pruned]
        if own:
            at, height = [one.number for one in own], [_percent(one) for one in own]
            axes.plot(at, height, mark, color=color, markersize=3.2, label=name)
    _draw_lowest(axes, shown)
    for one in shown:
        if one.chosen:
            (ring,) = axes.plot(one.number, _percent(one), "o", color=VERMILION, label="chosen")
            ring.set(markersize=7.0, markerfacecolor="none")
    axes.set_ylim(0, min(_HIGHEST, 1.05 * max(_percent(one) for one in shown)))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("trial [number]")
    axes.set_ylabel("error left on the held-out blocks [%]")
    legend_above(axes)
    caption = "Error left on the held-out blocks by the networks of each trial, over that of no network."
    return Plot(figure, "history", caption, provenance)


def _draw_lowest(axes: Axes, shown: Sequence[Tried]) -> None:
    """Draw a step line from the first finished trial to the last trial."""
    done = [one for one in shown if not one.pruned]
    if not done:
        return
    numbers = [one.number for one in done] + [max(one.number for one in shown)]
    lowest = np.minimum.accumulate([_percent(one) for one in done])
    axes.step(numbers, [*lowest, lowest[-1]], where="post", color=INK, linewidth=0.8, label="lowest so far")


def _percent(one: Tried) -> float:
    return 100 * one.share
