"""Whether an input changes on one side only: in horizons that judge, and in none that is fitted, or the other
way round.

One step or one pulse has one or two edges. Where no fitted horizon holds one, no parameter of the drive can
be fitted: what it lacks (a delay, a lag, a limit) then shows in the error of what judges, and no effect takes
it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hybridid.model import Model
from hybridid.simulation.windows import cut
from hybridid.trace.horizons.split import Split


def drive_changes_on_one_side(model: Model, split: Split) -> str:
    """Which inputs with a port of their own do, in words; empty if none does."""
    ours, theirs = (_changes(split, side) for side in (split.fitted, split.held_out))
    names = [channel.name for channel in split.records[0].input_channels]
    drives = [port.name for port in model.plant.ports if port.kind == "input"]
    told = [
        f" Beware: {name} changes in {'no horizon that judges' if here else 'no fitted horizon'}, so what "
        "the drive lacks cannot be shown. Another trace.horizon divides the record elsewhere; a record with "
        "more steps shows it."
        for name, here, there in zip(names, ours, theirs, strict=True)
        if here != there and name in drives
    ]
    return "".join(told)


def _changes(split: Split, side: Sequence[int]) -> list[bool]:
    """Whether each input changes in any horizon of one ``side``, without the gap at its end."""
    origins = cut(split.records, split.horizon, 1).origin
    parts = [
        split.records[k].inputs[start : stop - split.gap] for k, start, stop in (origins[n] for n in side)
    ]
    moved = [np.ptp(part, axis=0) > 0 for part in parts if len(part)]
    return [bool(any(column)) for column in zip(*moved, strict=True)]
