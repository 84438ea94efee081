"""How long a horizon should be: long enough to show the slow dynamics, short enough to have several."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from hybridid.advice.advice import Advice
from hybridid.estimators.estimate import Estimate
from hybridid.estimators.problem import Problem
from hybridid.model import Model
from hybridid.quantities import number, quantity
from hybridid.records.record import Record
from hybridid.simulation.linearised import linearised
from hybridid.validation.drift import growth

Array = NDArray[np.float64]
USUAL = 1.0
"""Seconds of a horizon, where the sampling is fast enough."""
LONG_STEP, STEPS = 0.05, 50
"""Sampling time in s above which ``USUAL`` holds too few samples, and the samples to take then."""
SHORTEST = 2
"""Samples that a horizon needs at least."""
SHARE = 0.1
"""Of all that is fitted, that a horizon should have at most: there are some to judge by. One that is proposed
has no more of the shortest record."""
FEW = 20
"""Samples below which a horizon shows little: its initial state is fitted to them. So it is longer then, up
to half of the shortest record."""
LEFT = 6
"""Horizons of the shortest record that are enough where its dynamics are slow."""
TOLERATED = 1.5
"""Times ``SHARE`` that are not told: a part of a recording may be fitted with the horizon of the whole. A
horizon that does not show the slowest dynamics is worth proposing if it is so many times as long."""
RESOLVED = 1 / 3
"""Of the shortest record, that the slowest dynamics may take and still be seen."""
GROWN, GROWS = 20.0, 5.0
"""Times e that an error grows by over what is fitted, as an exponent: above the first, the last digits of the
initial state decide; by the second over the horizon that is proposed then."""


def proposed_horizon(step: float, shortest: float, undriven: bool = False) -> float:
    """The horizon in s for records of ``shortest`` s at least, sampled every ``step`` s, to two digits.

    Where nothing drives the machine, what a friction takes adds up over all of the decay: then as long as
    still leaves horizons to judge by."""
    usual = np.inf if undriven else max(USUAL, STEPS * step if step > LONG_STEP else 0.0)
    return float(f"{min(usual, max(SHARE * shortest, min(FEW * step, shortest / 2))):.2g}")


def unsuitable_horizon(problem: Problem, estimate: Estimate) -> Iterator[Advice]:
    """Whether what is fitted in one run is too long for an unstable model, or the horizon of the fit too long
    for its records, or too short for what moves slowly; a fit to whole records has none."""
    if too_long := _grows(problem, estimate):
        yield Advice("horizon", too_long)
        return
    if estimate.settings.horizon is None:
        return
    step = problem.windows.dt
    durations = [float(record.time[-1] - record.time[0]) for record in problem.records]
    shortest, total, seconds = min(durations), sum(durations), estimate.settings.horizon * step
    slowest = slowest_time(problem.model, estimate.values, problem.records, RESOLVED * shortest)
    proposed = max(proposed_horizon(step, shortest), min(2 * slowest, SHARE * shortest))
    longest = max(SHARE * total, proposed, min(2 * slowest, shortest / LEFT))
    if seconds > TOLERATED * longest:
        yield Advice("horizon", _said(problem, estimate, total, proposed))
        return
    if float(f"{seconds:.2g}") < float(f"{slowest:.2g}"):  # a horizon is proposed to two digits
        yield Advice("horizon", _too_short(problem, estimate, shortest, slowest))


def _grows(problem: Problem, estimate: Estimate) -> str:
    """What to do where an error grows without end over what is fitted in one run; empty where it does not."""
    step = problem.windows.dt
    seconds = max(problem.windows.lengths) * step
    rate = growth(problem.model, problem.model.values(estimate.values), problem.records)
    if rate * seconds <= GROWN:
        return ""
    better = max(FEW, round(float(f"{GROWS / rate / step:.2g}")))
    return (
        "the model is unstable where the records hold it: a small error grows e-fold in "
        f"{quantity(1.0 / rate, 's', 2)}, so no initial state is exact enough for a run of "
        f"{number(seconds, 3)} s; estimator.horizon={better} ({number(better * step, 2)} s) is proposed"
    )


def _too_short(problem: Problem, estimate: Estimate, shortest: float, slowest: float) -> str:
    """What to do where one horizon does not show the slowest dynamics: a longer one, if there is any."""
    step, horizon = problem.windows.dt, estimate.settings.horizon or 0
    wanted = max(2 * slowest, proposed_horizon(step, shortest))
    better = max(SHORTEST, round(min(wanted, SHARE * shortest) / step))
    begins = (
        f"estimator.horizon={horizon} is {number(horizon * step, 3)} s, shorter than the slowest dynamics "
        f"that the records resolve ({number(slowest, 2)} s): their parameters show little in one horizon; "
    )
    if better > horizon and (better * step >= slowest or better >= TOLERATED * horizon):
        return begins + f"estimator.horizon={better} ({number(better * step, 2)} s) is proposed"
    return begins + (
        "these records are too short for a longer one, which would leave few horizons to judge by (the "
        f"shortest fitted record has {number(shortest, 3)} s); longer records show more, or "
        "estimator.horizon=null, which fits whole records"
    )


def _said(problem: Problem, estimate: Estimate, total: float, proposed: float) -> str:
    step, horizon = problem.windows.dt, estimate.settings.horizon or 0
    better = max(SHORTEST, round(proposed / step))
    return (
        f"estimator.horizon={horizon} is {number(horizon * step, 3)} s, longer than a tenth of all that is "
        f"fitted ({number(total, 3)} s): few horizons are left to judge by; "
        f"estimator.horizon={better} ({number(better * step, 2)} s) is proposed, or null for the whole record"
    )


def slowest_time(
    model: Model, values: Mapping[str, float], records: Sequence[Record], longest: float
) -> float:
    """The slowest dynamics of ``model`` at the parameters ``values`` in s: a decay's time constant or an
    oscillation's period, of those up to ``longest`` s, at the typical sample; 0 where there is none.

    Samples at which a port with an effort hardly moves, beside its epsilon, are left out, if it ever moves
    more: there a smoothed sign(v) is a damper of F_c/epsilon, and the slow creep behind it is no dynamics of
    the machine.
    """
    every = list(linearised(model, model.values(values), records))
    moving = [at for at in every if not at.creeps]
    times = [float(_times(at.modes, longest).max(initial=0.0)) for at in moving or every]
    return float(np.median(times)) if times else 0.0


def _times(modes: NDArray[np.complex128], longest: float) -> Array:
    """Time constants of the decays and periods of the oscillations of ``modes`` in s, up to ``longest``."""
    swings = np.abs(modes.imag) > np.abs(modes.real)
    seen = ((modes.real < 0) | swings) & (np.abs(modes) * longest >= 1.0)
    modes, swings = modes[seen], swings[seen]
    times = np.where(swings, 2 * np.pi, 1.0) / np.abs(modes)
    return np.asarray(times[times <= longest])
