"""Figure: all effects tried, by their decrease of the held-out error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hybridid.plotting.legends import legend_above
from hybridid.plotting.lettering import cut
from hybridid.plotting.looks import BLUE, GREEN, GRID_GREY, INK, ORANGE, SOFT_INK, VERMILION
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled
from hybridid.quantities import percent

ROW = 4.2  # mm
MOST = 40
NAME = 34  # characters of an effect's name that are printed
_MARKS = {
    "accepted": (GREEN, "o"),
    "passed": (BLUE, "s"),
    "unidentifiable": (ORANGE, "D"),
    "rejected": (SOFT_INK, "x"),
    "untried": (SOFT_INK, "|"),
}


@dataclass(frozen=True)
class Tried:
    """An effect at a port, its relative decrease of the held-out RMSE, and the decision about it.

    ``status`` is accepted, passed (but not the best), unidentifiable, rejected or untried.
    """

    name: str
    gain: float
    status: str


@styled
def trials_plot(
    tried: Sequence[Tried],
    worth: float,
    step: str,
    judged: str,
    provenance: str,
    width: float = DOUBLE_COLUMN,
) -> Plot:
    """At most ``MOST`` effects, the largest decrease on top; a line at ``worth``, the smallest accepted.

    Raises:
        PlotError: if nothing was tried or a status is none of those known.
    """
    if not tried:
        raise PlotError("trials: nothing was tried")
    for one in tried:
        if one.status not in _MARKS:
            raise PlotError(f"trials: status of {one.name} is {one.status!r}, allowed: {', '.join(_MARKS)}")
    shown = sorted(tried, key=lambda one: -one.gain)[:MOST]
    figure = new_figure(width, 22 + ROW * len(shown), f"effects tried, {step}, {judged}", provenance)
    axes = figure.subplots()
    lowest = min(0.0, *(max(one.gain, -0.3) for one in shown)) * 100
    axes.axvline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    axes.axvline(worth * 100, color=VERMILION, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
    for row, one in enumerate(shown):
        colour, marker = _MARKS[one.status]
        gain = max(one.gain, -0.3) * 100
        axes.plot([0.0, gain], [row, row], color=GRID_GREY, linewidth=1.6, zorder=2, solid_capstyle="butt")
        axes.plot(gain, row, marker, color=colour, markersize=3.4, markeredgewidth=0.9, zorder=3)
    for status, (colour, marker) in _MARKS.items():
        if any(one.status == status for one in shown):
            axes.plot([], [], marker, color=colour, markersize=3.4, markeredgewidth=0.9, label=status)
    axes.plot(
        [],
        [],
        color=VERMILION,
        linewidth=0.8,
        linestyle=(0, (4, 2)),
        label=f"worth having, {percent(worth)}",
    )
    legend_above(axes)
    axes.set_yticks(range(len(shown)), [cut(one.name, NAME) for one in shown], color=INK)
    axes.set_ylim(len(shown) - 0.4, -0.6)
    axes.set_xlim(lowest - 3, max(5.0, *(one.gain * 100 for one in shown)) * 1.08)
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    axes.set_xlabel("held-out RMSE lower by [%]")
    left_out = f"; the best {MOST} of {len(tried)}" if len(tried) > MOST else ""
    caption = (
        f"Every effect tried, refitted with all parameters, {step}, {judged} ({provenance}): relative "
        f"decrease of the RMSE, and what was decided{left_out}."
    )
    return Plot(figure, "trials", caption, provenance)
