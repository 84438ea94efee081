"""What the study found, as Markdown. Everything is simulated."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from benchmarks.strangers.play import SECONDS, Outcome

OUT = Path(__file__).resolve().parents[2] / "outputs" / "studies"
HEAD = ("machine", "template", "new, run, trace [s]", "CPU [s]", "largest error of a parameter", "verdict")


def row(one: Outcome) -> str:
    """One machine as a row of the table."""
    off = "–" if one.off is None else f"{one.off:.2%} ({one.parameter})"
    wall = ", ".join(f"{seconds:.0f}" for seconds in one.wall)
    cells = (one.machine, one.template, wall, f"{sum(one.cpu):.0f}", off, one.sentence)
    return f"| {' | '.join(cells)} |"


def table(rows: Sequence[Outcome]) -> str:
    """All machines, and how many took at most 5 minutes."""
    quick = sum(sum(one.wall) <= 300 for one in rows)
    return "\n".join(
        [
            f"From a recording to a traced report, by three commands (simulated, {SECONDS:g} s at 500 Hz; "
            "tanks: at 1 Hz).",
            "",
            f"| {' | '.join(HEAD)} |",
            "|" + "---|" * len(HEAD),
            *map(row, rows),
            "",
            f"at most 5 minutes: {quick} of {len(rows)}",
        ]
    )


def write(rows: Sequence[Outcome]) -> Path:
    """``strangers.md``, whole or not at all."""
    OUT.mkdir(parents=True, exist_ok=True)
    part = OUT / "strangers.md.part"
    part.write_text(table(rows) + "\n", encoding="utf-8")
    os.replace(part, OUT / "strangers.md")
    return OUT / "strangers.md"
