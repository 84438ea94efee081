"""The length of the horizons where it is left open: by the slowest dynamics, and by what the records give."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from hybridid.advice.decay import undriven
from hybridid.advice.horizon import RESOLVED, slowest_time
from hybridid.estimators.start import regression_start
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.trace.split import LONGEST, automatic_horizon


def horizon_for(
    model: Model,
    start: Mapping[str, float] | None,
    fitted: Sequence[Record],
    held_out: Sequence[Record],
    usual: float = LONGEST,
) -> float:
    """Seconds of a horizon, as ``automatic_horizon`` has it, for the dynamics of ``model`` at the parameters
    ``start`` (None: by regression on the records ``fitted``, else the guesses). Where nothing drives the
    machine, what is missing adds up over the whole decay: then the slowest that the records may resolve.
    """
    ours, theirs = ([float(r.counts.sum()) * r.dt for r in part] for part in (fitted, held_out))
    if start is None:
        found = regression_start(model, fitted)
        values = model.values() if found is None else found
        start = {p.name: float(v) for p, v in zip(model.parameters, values, strict=True)}
    longest = RESOLVED * min(float(record.time[-1] - record.time[0]) for record in fitted)
    slowest = longest if all(map(undriven, fitted)) else slowest_time(model, start, fitted, longest)
    seconds = automatic_horizon(ours, theirs, usual, slowest, fitted[0].dt)
    return seconds if seconds <= usual else float(f"{seconds:.2g}")
