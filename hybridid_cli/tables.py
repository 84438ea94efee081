"""Tables and lines as text: for a person's terminal, or plain for a file."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence

from rich import box
from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

_WIDE = 200


def rendered(parts: Sequence[RenderableType]) -> str:
    """Tables and lines as text, coloured if stdout is a terminal, one width if not."""
    watched = sys.stdout.isatty()
    width = None if watched else _WIDE
    console = Console(width=width, highlight=False, markup=False, force_terminal=watched or None)
    with console.capture() as capture:
        for part in parts:
            console.print(part, soft_wrap=not isinstance(part, Table))
    return "\n".join(line.rstrip() for line in capture.get().splitlines())


def table(title: str, columns: Sequence[str], words: Sequence[int] = (0,)) -> Table:
    """An empty table; ``words`` are the columns that hold words, which stand left; numbers stand right."""
    made = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for column, name in enumerate(columns):
        made.add_column(name, justify="left" if column in words else "right", overflow="fold")
    return made


def provenance(word: str) -> Text:
    """``measured`` or ``simulated``; what is simulated stands out."""
    return Text(word, style="bold magenta" if word == "simulated" else "")


def view(horizon: float | None, kind: str = "") -> str:
    """How a model was run: free, anew every ``horizon`` seconds, or of the ``kind`` loop."""
    if kind == "loop":
        return "in the loop"
    return "free run" if horizon is None else f"horizon {horizon:g} s"


def warnings(lines: Iterable[str]) -> list[RenderableType]:
    """A line each."""
    return [Text(f"WARNING: {line}", style="yellow") for line in lines]
