"""Which network our rule took, without looking at the validation record, and which the thesis took."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pipelines.findings import residual_of
from pipelines.thesis import chapter4, chapter6
from pipelines.thesis.look_up import Missing, Outcomes, score, tree_of
from pipelines.thesis.reference import NetworkOf, ScoreTable


def choices(chapter: int, outcomes: Outcomes) -> tuple[str, ...]:
    """A sentence for each choice that the chapter's results hold."""
    makers = {4: _vehicle, 6: _emps}
    return tuple(makers[chapter](outcomes)) if chapter in makers else ()


def _vehicle(outcomes: Outcomes) -> Iterator[str]:
    """The network of each output: by our rule, and by the thesis' error."""
    for table in chapter4.TABLES:
        if not isinstance(table, ScoreTable):
            continue
        rows = [row for row in table.rows if isinstance(row.ours, NetworkOf) and row.thesis is not None]
        chosen = [row.label for row in rows if _is_chosen(row.ours, outcomes)]
        if not chosen:
            continue
        best = min(rows, key=lambda row: row.thesis.error if row.thesis else float("inf"))
        yield (
            f"{table.title}: chosen here {chosen[0]}, by the lowest free-run error on held-out blocks of "
            f"the identification record; the thesis chose {best.label}, by the error on the record that "
            "trained it."
        )


def _is_chosen(where: Any, outcomes: Outcomes) -> bool:
    try:
        return score(where, outcomes).chosen
    except Missing:
        return False


def _emps(outcomes: Outcomes) -> Iterator[str]:
    """The number of nodes that held-out blocks of the identification record choose."""
    for experiment in chapter6.NODES.values():
        try:
            report = residual_of(tree_of(experiment, outcomes))
        except Missing:
            continue
        rows = {row["nodes"]: row for row in report["candidates"]}
        chosen = [nodes for nodes, row in rows.items() if row["chosen"]]
        if set(chapter6.NODES) <= set(rows) and chosen:
            scored = ", ".join(f"{nodes}: {row['score']:.3g}" for nodes, row in sorted(rows.items()))
            yield (
                f'Nodes chosen without the validation record: {chosen[0]}, by the rule "{report["rule"]}". '
                f"Error over that of the gray box on those blocks, by nodes: {scored}."
            )
            return
