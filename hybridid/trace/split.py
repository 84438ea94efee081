"""What is fitted and what is held out: horizons of other records, or blocks with gaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hybridid.records.record import Record
from hybridid.simulation.windows import cut

GAP = 0.1
"""Share of a horizon left out at its end where one record serves both ways."""
FEWEST = 4
"""Horizons on each side below which no verdict is possible."""


@dataclass(frozen=True)
class Split:
    """Horizons of ``horizon`` samples over ``records``: the numbers fitted, the numbers held out.

    ``gap`` samples at the end of each horizon serve neither side.
    """

    records: tuple[Record, ...]
    horizon: int
    fitted: tuple[int, ...]
    held_out: tuple[int, ...]
    described: str
    gap: int = 0

    def __post_init__(self) -> None:
        if min(len(self.fitted), len(self.held_out)) < FEWEST:
            raise ValueError(
                f"trace needs at least {FEWEST} horizons to fit and {FEWEST} to hold out; {self.described} "
                f"gives {len(self.fitted)} and {len(self.held_out)}: shorten trace.horizon or add a record"
            )


def by_record(fitted: Sequence[Record], held_out: Sequence[Record], horizon: int) -> Split:
    """Fit on some records, judge on others."""
    records = (*fitted, *held_out)
    origins = cut(records, horizon, 1).origin
    ours = tuple(k for k, (record, _, _) in enumerate(origins) if record < len(fitted))
    theirs = tuple(k for k in range(len(origins)) if k not in ours)
    names = (" and ".join(r.name for r in part) for part in (fitted, held_out))
    return Split(records, horizon, ours, theirs, "fitted on {}, judged on {}".format(*names))


def by_blocks(records: Sequence[Record], horizon: int) -> Split:
    """Fit every other horizon, judge on those between, with a gap after each.

    The gap keeps what the noise at a horizon's end still tells of the next start. Fine
    alternation lets both sides see all speeds and positions of the record.
    """
    origins = cut(tuple(records), horizon, 1).origin
    names = " and ".join(record.name for record in records)
    return Split(
        tuple(records),
        horizon,
        fitted=tuple(range(0, len(origins), 2)),
        held_out=tuple(range(1, len(origins), 2)),
        described=f"fitted and judged on alternate horizons of {names}",
        gap=int(GAP * horizon),
    )
