"""The league's figures: what was planted against what was named, and the held-out error before and after."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from benchmarks.league.ours import NAME
from benchmarks.league.scoring import Round
from hybridid.plotting.looks import BLUE, DATA_GREY, INK, SOFT_INK, VERMILION
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled

NOTHING = "nothing"
ROW = 3.4  # mm, of the confusion matrix


@styled
def confusion(found: Sequence[Round], player: str) -> Plot:
    """Counts of planted (rows) against named first (columns); what is right is framed."""
    planted, named = [_planted(r) for r in found], [_effect(r.first) for r in found]
    rows = [
        *sorted({p for p in planted if p[0] != "("} - {NOTHING}),
        *sorted(p for p in set(planted) if p[0] == "("),
    ]
    rows += [NOTHING] * (NOTHING in planted)
    inside = [r for r in rows if r[0] != "(" and r != NOTHING]
    columns = [*inside, *sorted(set(named) - set(inside) - {NOTHING}), NOTHING]
    counts = Counter(zip(planted, named, strict=True))
    table = np.array([[counts[row, column] for column in columns] for row in rows], dtype=float)
    figure = new_figure(DOUBLE_COLUMN, 45 + ROW * len(rows), f"planted and named: {player}", "simulated")
    axes = figure.add_subplot()
    share = table / np.maximum(table.sum(axis=1, keepdims=True), 1)
    axes.imshow(share, cmap="Blues", vmin=0, vmax=1.4, aspect="auto", interpolation="nearest")
    axes.set_xticks(range(len(columns)), columns, rotation=90, fontsize=5.5)
    axes.set_yticks(range(len(rows)), rows, fontsize=5.5)
    axes.set_xlabel("named first")
    axes.set_ylabel("planted")
    axes.grid(False)
    axes.tick_params(length=0)
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            right = column == (row if row in inside else NOTHING)
            if table[i, j]:
                colour = "white" if share[i, j] > 0.5 else INK if right else VERMILION
                axes.text(j, i, f"{table[i, j]:.0f}", ha="center", va="center", fontsize=5.5, color=colour)
            if right:
                axes.add_patch(_frame(i, j))
    caption = (
        "Effects planted (rows; in brackets those outside the library) and named first (columns) by "
        f"{player}, where an oracle can detect them"
    )
    return Plot(figure, f"confusion_{player}", caption, "simulated")


def _frame(i: int, j: int):
    from matplotlib.patches import Rectangle

    return Rectangle((j - 0.5, i - 0.5), 1, 1, fill=False, edgecolor=SOFT_INK, linewidth=0.6)


def _planted(r: Round) -> str:
    name = _effect(r.truth)
    return f"({name})" if r.category == "outside" else name


def _effect(name: str | None) -> str:
    return NOTHING if name is None else name.rsplit(".", 1)[-1]


@styled
def gains(found: Sequence[Round], oracle: Mapping[str, Mapping[str, float]]) -> Plot:
    """Held-out error of our trace before and after, and the oracle's, for each scenario that counts."""
    own = sorted((r for r in found if r.player == NAME and r.counts), key=lambda r: r.answer["before"])
    figure = new_figure(DOUBLE_COLUMN, 75, "held-out error over horizons, before and after", "simulated")
    axes = figure.add_subplot()
    places = np.arange(len(own))
    for k, r in enumerate(own):
        axes.plot([k, k], [r.answer["before"], r.answer["after"]], color=DATA_GREY, linewidth=0.6, zorder=2)
    axes.plot(places, [r.answer["before"] for r in own], "o", ms=2.2, color=INK, label="declared model")
    for right, colour, label in ((True, BLUE, "trace, right"), (False, VERMILION, "trace, wrong")):
        part = [(k, r.answer["after"]) for k, r in enumerate(own) if r.covered is right]
        if part:
            axes.plot(*zip(*part, strict=True), "s", ms=2.2, color=colour, label=label)
    told = [(k, oracle[r.key]["after"]) for k, r in enumerate(own) if r.key in oracle]
    if told:
        axes.plot(*zip(*told, strict=True), "_", ms=4, color=SOFT_INK, label="told what was planted")
    axes.set_yscale("log")
    axes.set_xlabel("scenario, by error before")
    axes.set_ylabel("held-out RMSE over spread [–]")
    axes.legend(ncols=4, loc="upper left")
    caption = "Held-out error over horizons of the declared model, of our trace's last and of the oracle's"
    return Plot(figure, "gains", caption, "simulated")
