"""What free runs say against a verdict: they become worse, or leave far more than horizons do.

Effects are judged over horizons of about a second. In free run an error adds up over the whole record. An
effect that truly acts lowers it there, too, or leaves it. Where the free run becomes much worse, the effect
mends the start of each horizon, and what it does in the long run is wrong: a lag of two seconds in a sensor
can pass for a brake that acts at rest.

A free run of an integrating machine also adds up what little its parameters err by. So this withdraws no
effect: the engineer is told, and decides. Of an unstable machine a free run says nothing at all.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from hybridid.quantities import quantity
from hybridid.trace.results.before_after import ScoreRow
from hybridid.trace.results.result import Trace


def worse_in_free_run(found: Trace) -> str:
    """Where the free run becomes worse by more than ``Rules.refuted`` times with what was accepted, in words;
    empty where it does not, or nothing was accepted."""
    if not found.accepted:
        return ""
    before = _free_runs(found.before)
    times = {
        place: row.rmse / before[place].rmse if not row.remark else math.inf
        for place, row in _free_runs(found.after).items()
        if place in before and before[place].rmse > 0
    }
    worst = max(times, key=times.__getitem__, default=None)
    if worst is None or times[worst] <= found.rules.refuted:
        return ""
    first, last = before[worst], _free_runs(found.after)[worst]
    grows = f"grows from {quantity(first.rmse, first.unit, 3)} to {quantity(last.rmse, last.unit, 3)}"
    change = f"diverges (without them {quantity(first.rmse, first.unit, 3)})" if last.remark else grows
    return (
        f" Beware: in free run of {last.record} the error of {last.output} {change}. In the long run what "
        "was accepted predicts worse than the declared model."
    )


def unstable(found: Trace, rate: float) -> str:
    """That the free runs say nothing of a model in which an error grows at ``rate`` [1/s]; empty where each
    is better than doing nothing."""
    if all(row.r2 > 0 and not row.remark for row in _free_runs(found.after).values()):
        return ""
    return (
        f" The model is unstable where the records hold it: a small error grows e-fold in "
        f"{quantity(1.0 / rate, 's', 2)}, so its free runs say nothing."
    )


def far_in_free_run(found: Trace, drift: Sequence[str]) -> str:
    """That the last model leaves far more in free run than over horizons, and than noise and simulation do;
    else empty. The outputs of ``drift`` follow what integrates or grows: their free runs tell little."""
    worst = _farthest(found, drift)
    return f"{worst} Longer horizons (trace.horizon) may show what is missing." if worst else ""


def adds_up_in_free_run(found: Trace, drift: Sequence[str]) -> str:
    """That a model with what was accepted comes near the noise over horizons, and leaves far more in free
    run; else empty. In outputs of ``drift`` the slightest error of a parameter adds up."""
    worst = _farthest(found, drift) if found.accepted and found.times <= found.rules.far else ""
    two = "the errors of the parameters, and the difference between the named law and the true one"
    return f"{worst} Over a long run two things add up: {two}." if worst else ""


def _farthest(found: Trace, drift: Sequence[str]) -> str:
    """In which free run the last model leaves far more than over horizons, and than noise and simulation do,
    in words; empty where it does in none. The outputs of ``drift`` do not count."""
    limits = {
        name: math.hypot(one.value, one.simulation)
        for name, one in found.noise_floor.items()
        if name not in drift
    }
    runs = [row for row in _free_runs(found.after).values() if limits.get(row.output) and not row.remark]
    worst = max(runs, key=lambda row: row.rmse / limits[row.output], default=None)
    if worst is None:
        return ""
    times = worst.rmse / limits[worst.output]
    if times <= found.rules.far * max(found.times, 1.0):
        return ""
    return (
        f" Beware: in free run of {worst.record} the model leaves {quantity(worst.rmse, worst.unit, 3)} of "
        f"{worst.output}, {times:.0f} times what noise and simulation do."
    )


def _free_runs(rows: Sequence[ScoreRow]) -> dict[tuple[str, str], ScoreRow]:
    """The scores in free run, without a network, by record and output."""
    return {(r.record, r.output): r for r in rows if r.view == "free_run" and not r.network}
