"""Tables and lines as text: for a person's terminal, or plain for a file."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from rich import box
from rich.console import Console, RenderableType
from rich.table import Table

_WIDE = 200


def rendered(parts: Sequence[RenderableType]) -> str:
    """Tables and lines as text, coloured if stdout is a terminal, one width if not."""
    watched = sys.stdout.isatty()
    console = Console(width=None if watched else _WIDE, highlight=False, force_terminal=watched or None)
    with console.capture() as capture:
        for part in parts:
            console.print(part, soft_wrap=not isinstance(part, Table))
    return "\n".join(line.rstrip() for line in capture.get().splitlines())


def table(title: str, columns: Sequence[tuple[str, str]]) -> Table:
    """An empty table; ``columns`` are (name, ``left`` or ``right``)."""
    made = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for name, side in columns:
        made.add_column(name, justify="right" if side == "right" else "left")
    return made
