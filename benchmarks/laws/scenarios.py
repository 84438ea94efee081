"""Scenarios of the study: machines with an effect that is taken out of the library, or with nothing missing.

They are drawn as those of the drawn league are, beyond its numbers; a further series judges after somebody
looked at the first. Only effects without memory at a port of
efforts count: a composed law has no state of its own.
"""

from __future__ import annotations

from itertools import count, islice

from benchmarks.drawn.draw import A_SERIES, Draw, draw_of
from hybridid.effects.library import EFFECTS

FIRST = 1000
"""Number of the first draw of a series."""
EACH = 60
"""Scenarios of either kind."""
CATEGORIES = ("library", "nothing")
STATIC = frozenset(e.id for e in EFFECTS if e.kind == "effort" and not e.states)


def scenarios(series: int = 0) -> list[Draw]:
    """All draws of a series, those that hide something and those that hide nothing in turn."""
    first = FIRST + A_SERIES * series
    hiding = (draw_of(first + 2 * k) for k in count())
    suited = islice((d for d in hiding if d.wanted is not None and d.wanted.what in STATIC), EACH)
    empty = (draw_of(first + 2 * k + 1) for k in range(EACH))
    return [draw for pair in zip(suited, empty, strict=True) for draw in pair]
