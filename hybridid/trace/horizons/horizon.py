"""The length of the horizons where it is left open: by the slowest dynamics, and by what the records give."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from hybridid.advice.decay import undriven
from hybridid.advice.horizon import FEW, GROWN, GROWS, RESOLVED, slowest_time
from hybridid.estimators.start import regression_start
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.trace.horizons.split import LONGEST, automatic_horizon
from hybridid.validation.drift import growth


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

    Where the model is unstable and a small error would grow by more than e to the power of ``GROWN``, no
    initial state is exact enough for such a horizon: then one over which it grows by ``GROWS``.
    """
    ours, theirs = ([float(r.counts.sum()) * r.dt for r in part] for part in (fitted, held_out))
    if start is None:
        found = regression_start(model, fitted)
        values = model.values() if found is None else found
        start = {p.name: float(v) for p, v in zip(model.parameters, values, strict=True)}
    longest = RESOLVED * min(float(record.time[-1] - record.time[0]) for record in fitted)
    slowest = longest if all(map(undriven, fitted)) else slowest_time(model, start, fitted, longest)
    seconds = automatic_horizon(ours, theirs, usual, slowest, fitted[0].dt)
    rate = growth(model, model.values(start), fitted)
    if rate * seconds > GROWN:
        seconds = float(f"{max(GROWS / rate, FEW * fitted[0].dt):.2g}")
    return seconds if seconds <= usual else float(f"{seconds:.2g}")
