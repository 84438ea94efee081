"""Where the studies write, and how: each file whole or not at all, tables as Markdown."""

from __future__ import annotations

import resource
from collections.abc import Iterable, Sequence
from pathlib import Path

from pipelines.shared.tree import write_text

OUT = Path(__file__).resolve().parents[1] / "outputs" / "studies"


def write(path: Path, text: str) -> Path:
    """Write ``text`` and a line's end to ``path``, whose folder is made; returns ``path``."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, f"{text}\n")
    return path


def table(header: Sequence[object], rows: Iterable[Sequence[object]]) -> list[str]:
    """The lines of a table in Markdown."""
    return [f"| {' | '.join(map(str, cells))} |" for cells in (header, ["---"] * len(header), *rows)]


def cpu_seconds() -> float:
    """CPU time in s of all processes that this one has started and seen end."""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return ended.ru_utime + ended.ru_stime
