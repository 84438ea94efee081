"""What is fitted and what is held out: horizons of other records, or blocks with gaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hybridid.records.record import Record
from hybridid.simulation.windows import cut

GAP = 0.1
"""Share of a horizon left out at its end where one record serves both ways."""
LONGEST = 1.0
"""Seconds of an automatic horizon at most."""
ENOUGH = 10
"""Horizons to fit, and to judge by, that the automatic horizon leaves."""
FEW = 6
"""Horizons on each side that are left where the dynamics are slow."""
SAMPLES = 3
"""Of an automatic horizon at least."""
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

    @property
    def swapped(self) -> Split:
        """The same horizons: what was held out is fitted, and what was fitted is held out."""
        return replace(self, fitted=self.held_out, held_out=self.fitted)

    @property
    def fitted_records(self) -> list[Record]:
        """The records of which a horizon is fitted."""
        origins = cut(self.records, self.horizon, 1).origin
        return [self.records[k] for k in sorted({origins[one][0] for one in self.fitted})]

    @property
    def fitted_alone(self) -> Split:
        """The records of which a horizon is fitted, without the others: what is fitted judges, too. For fits
        whose held-out error nobody reads."""
        origins = cut(self.records, self.horizon, 1).origin
        kept = {origins[one][0] for one in self.fitted}
        now = [number for number, origin in enumerate(origins) if origin[0] in kept]
        fitted = tuple(now.index(one) for one in self.fitted)
        return replace(self, records=tuple(self.fitted_records), fitted=fitted, held_out=fitted)

    def shorter(self, samples: int) -> Split:
        """The same records in horizons of ``samples``: fitted are those within what was fitted, held out
        those within what was held out."""
        before, now = (cut(self.records, length, 1).origin for length in (self.horizon, samples))

        def within(chosen: Sequence[int]) -> tuple[int, ...]:
            stretches = _joined([before[k] for k in chosen], self.gap)
            return tuple(
                number
                for number, (record, start, stop) in enumerate(now)
                if any(r == record and a <= start and stop <= b for r, a, b in stretches)
            )

        return replace(
            self,
            horizon=samples,
            fitted=within(self.fitted),
            held_out=within(self.held_out),
            gap=0,
        )

    def longer(self, samples: int) -> Split:
        """The same records in horizons of ``samples``, divided in the same way.

        Raises:
            ValueError: if there are too few of them for a verdict.
        """
        origins = cut(self.records, self.horizon, 1).origin
        ours, theirs = ({origins[k][0] for k in chosen} for chosen in (self.fitted, self.held_out))
        if ours & theirs:
            return by_blocks(self.records, samples)
        fitted, held_out = ([self.records[k] for k in sorted(chosen)] for chosen in (ours, theirs))
        return by_record(fitted, held_out, samples)

    def __post_init__(self) -> None:
        if min(len(self.fitted), len(self.held_out)) < FEWEST:
            raise ValueError(
                f"trace needs at least {FEWEST} horizons to fit and {FEWEST} to hold out; {self.described} "
                f"gives {len(self.fitted)} and {len(self.held_out)}: shorten trace.horizon (auto chooses "
                "one) or add a record"
            )


def divided(fitted: Sequence[Record], held_out: Sequence[Record], seconds: float) -> Split:
    """Horizons of ``seconds`` to fit, and those of ``held_out`` to judge by.

    If nothing is held out, every other horizon of ``fitted`` judges.

    Raises:
        ValueError: if a horizon is shorter than two samples, or there are too few horizons for a verdict.
    """
    samples = round(seconds / fitted[0].dt)
    if samples < 2:
        raise ValueError(
            f"trace.horizon is {seconds:g} s: record {fitted[0].name} is sampled every {fitted[0].dt:g} s, "
            "a horizon needs 2 samples"
        )
    return by_record(fitted, held_out, samples) if held_out else by_blocks(fitted, samples)


def check_measured(split: Split) -> None:
    """Check that horizons of either side tell enough of each output.

    Raises:
        ValueError: if an output was measured in fewer than ``FEWEST`` of them.
    """
    if all(record.absent is None for record in split.records):
        return
    measured = np.asarray(cut(split.records, split.horizon, 1).cells.any(axis=1))
    for what, rows in (("fitted", split.fitted), ("held out", split.held_out)):
        for channel, seen in zip(split.records[0].output_channels, measured[list(rows)].T, strict=True):
            if seen.sum() < FEWEST:
                raise ValueError(
                    f"trace needs output {channel.name} in at least {FEWEST} of the {len(seen)} horizons "
                    f"{what}, and it was measured in {seen.sum()} of them; {split.described}: divide the "
                    "records in another way (trace.held_out), or leave the output out of the model"
                )


def automatic_horizon(
    fitted: Sequence[float],
    held_out: Sequence[float],
    usual: float = LONGEST,
    slowest: float = 0.0,
    step: float = 0.0,
) -> float:
    """Seconds of a horizon: ``usual``, more where the machine is slow, and less where the records are short.

    ``fitted`` and ``held_out`` are the durations [s] of the records; if nothing is held out, both sides share
    the fitted ones. Twice the ``slowest`` dynamics [s] fit into a horizon, if either side still has
    ``ENOUGH``, and once, if it has ``FEW``: what a shorter one shows, its fitted initial state may hide. It
    holds ``SAMPLES`` every ``step`` s in any case.
    """
    least = min(sum(fitted), sum(held_out)) if held_out else sum(fitted) / 2
    seconds = min(max(usual, 2 * slowest), max(least / ENOUGH, min(slowest, least / FEW)))
    return max(seconds, SAMPLES * step)


def _joined(origins: Sequence[tuple[int, int, int]], gap: int) -> list[tuple[int, int, int]]:
    """The stretches (record index, first sample, end sample) that horizons cover without the ``gap`` samples
    at the end of each."""
    joined: list[tuple[int, int, int]] = []
    for record, start, stop in sorted(origins):
        if joined and joined[-1][0] == record and joined[-1][2] == start:
            start = joined.pop()[1]
        joined.append((record, start, stop - gap))
    return joined


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
