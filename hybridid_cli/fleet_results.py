"""The traces of a fleet as text for the terminal: a line for each machine."""

from __future__ import annotations

from rich.console import RenderableType
from rich.text import Text

from hybridid_cli.sweep_results import MOST, ending
from hybridid_cli.tables import rendered, table
from pipelines.sweep.conduct import SweepOutcome
from pipelines.sweep.fleet import Fleet, counts, header, line


def fleet_summary(swept: SweepOutcome, found: Fleet) -> str:
    """The table of machines, how many of them lack each effect, and the page's path."""
    names, words = header(found), len(found.axes)
    marks = " and ".join(sorted({one.provenance for one in found.machines}))
    made = table(f"Machines ({marks})", names, words=(*range(words + 2), len(names) - 1))
    for one in found.machines[:MOST]:
        made.add_row(*line(one, found))
    parts: list[RenderableType] = [made] if found.machines else []
    if len(found.machines) > MOST:
        parts.append(Text(f"the first {MOST}; {len(found.machines) - MOST} more on the page"))
    parts += [Text(said) for said in counts(found)]
    return rendered([*parts, *ending(swept, "traced")])
