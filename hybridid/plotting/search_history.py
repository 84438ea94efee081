"""Figure: the held-out error of every trial of a search, and the lowest so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hybridid.plotting.legends import legend_above
from hybridid.plotting.looks import BLUE, INK, SOFT_INK, VERMILION
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled


@dataclass(frozen=True)
class Tried:
    """A trial: its error, of one that was ``pruned`` the last that was seen."""

    number: int
    share: float
    pruned: bool
    chosen: bool


@styled
def history_plot(tried: Sequence[Tried], title: str, provenance: str, width: float = DOUBLE_COLUMN) -> Plot:
    """A dot a trial, a cross one that was pruned, a step line at the lowest so far, a ring at the chosen.

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
        axes.plot(
            [o.number for o in own], [o.share for o in own], mark, color=color, markersize=3.2, label=name
        )
    done = [one for one in shown if not one.pruned]
    if done:
        lowest = np.minimum.accumulate([one.share for one in done])
        numbers = [one.number for one in done]
        axes.step(numbers, lowest, where="post", color=INK, linewidth=0.8, label="lowest so far")
    for one in shown:
        if one.chosen:
            axes.plot(
                one.number,
                one.share,
                "o",
                color=VERMILION,
                markersize=7,
                markerfacecolor="none",
                label="chosen",
            )
    axes.set_yscale("log")
    axes.set_xlabel("trial")
    axes.set_ylabel("held-out share")
    legend_above(axes)
    caption = "Error left on the held-out blocks by the networks of each trial, over that of no network."
    return Plot(figure, "history", caption, provenance)
