"""The verdict on a fit in words."""

from __future__ import annotations

import math
from collections.abc import Sequence

from hybridid.estimators.estimate import Estimate, Left
from hybridid.estimators.floor import FAR, MISFIT
from hybridid.naming import listed
from hybridid.quality.hypotheses import Hypothesis
from hybridid.quality.trial import Trial
from hybridid.quality.verdict import Verdict, View
from hybridid.quantities import number, percent, quantity


def where(view: View) -> str:
    """``in free run``, or over which horizons."""
    return "in free run" if view.horizon is None else f"over horizons of {number(view.horizon, 3)} s"


def worse_than_nothing(views: Sequence[View], good: Sequence[View] = ()) -> str:
    """Of which outputs a constant predicts as well, and over which horizons, ``good``, the model does not."""
    said = "; ".join(f"{v.output} {where(v)}: {_beside_nothing(v)}" for v in views)
    told = f"the model is no better than doing nothing ({said})"
    if not good:
        return told
    beside = "; ".join(f"{v.output} {where(v)}: {_beside_nothing(v)}" for v in good)
    return (
        f"{told}, but over horizons it explains most of the motion ({beside}): in a free run the errors add "
        "up; hybridid trace looks for what the model lacks"
    )


def drifts(views: Sequence[View], horizons: View, growth: float) -> str:
    """That the free runs ``views`` are bad by nature, and that ``horizons`` are to be looked at; an error
    grows at the rate ``growth`` [1/s], 0 if the model is not unstable."""
    said = "; ".join(f"{v.output}: {_beside_nothing(v)}" for v in views)
    if growth > 0:
        return (
            f"the free run diverges ({said}), since the model is unstable where the record holds it: without "
            f"the loop that holds it, a small error grows e-fold in {quantity(1.0 / growth, 's', 2)}; its "
            f"errors {where(horizons)} judge it. If the machine is stable, the model is wrong"
        )
    return (
        f"the free run drifts ({said}), since the model integrates: nothing brings it back within a record, "
        f"and small errors add up; its errors {where(horizons)} judge it"
    )


def _beside_nothing(view: View) -> str:
    return f"RMSE {quantity(view.rmse, view.unit, 3)}, doing nothing {quantity(view.nothing, view.unit, 3)}"


def explained(named: Sequence[Hypothesis], best: Trial, given: Trial) -> str:
    """What would explain most of what the fit leaves. A value that physics forbids, as a negative friction,
    stands for another law of the same variable."""
    what = ", or ".join(dict.fromkeys(one.said for one in named))
    windows = best.data.problem.windows
    seconds = number(max(windows.lengths) * windows.dt, 2)
    shares = f"{percent(_two_digits(best.share))} of the motion, not {percent(_two_digits(given.share))}"
    pieces = f"refitted over pieces of {seconds} s"
    said = f"the records say that {what}: the same model then leaves {shares} ({pieces})"
    if not any(one.released for one in named):
        return said
    return f"{said}. If the bound is physics, another law is there, which hybridid trace looks for"


def incomplete(left: Sequence[Left]) -> str:
    """What is left beside noise and simulation."""
    said = "; ".join(_beside(one) for one in left if one.exceeded)
    return f"the model lacks physics ({said}); hybridid trace looks for it"


def explains_little(views: Sequence[View]) -> str:
    """That most of the motion is left, for an unknown reason."""
    said = "; ".join(
        f"{v.output} {where(v)}: {percent(_two_digits((v.rmse / v.nothing) ** 2))}" for v in views
    )
    return f"the model leaves most of the motion ({said}), and the records do not tell whether that is noise"


def _beside(one: Left) -> str:
    rmse = quantity(one.rmse, one.unit, 3)
    if math.isfinite(one.noise):
        limit = quantity(math.hypot(one.noise, one.simulation), one.unit, 2)
        return f"{one.output}: it leaves {rmse}, noise and simulation leave {limit}"
    return (
        f"{one.output}: it leaves {rmse}, louder where the machine moves (p = {one.louder:.1g}); the record "
        "does not tell the sensor's noise"
    )


def too_long_steps(coarse: Sequence[Left], substeps: int) -> str:
    """Which outputs the length of the simulation's steps changes by as much as the fit leaves."""
    said = "; ".join(
        f"{one.output}: shorter steps change it by {quantity(one.step, one.unit, 2)}, and the fit leaves "
        f"{quantity(one.rmse, one.unit, 3)}"
        for one in coarse
    )
    return (
        f"the fitted motion is too fast for the simulation's steps ({said}): the estimates are those of the "
        f"steps; try estimator.substeps={4 * substeps}"
    )


def smoothing_decides(outputs: Sequence[Left], samples: int | None) -> str:
    """Which outputs the smoothing of sign(v) changes by as much as the fit leaves, and what to do: horizons
    of so many ``samples``, or a smaller epsilon."""
    said = "; ".join(
        f"{one.output}: without the smoothing it changes by some {quantity(one.smeared, one.unit, 2)}, and "
        f"the fit leaves {quantity(one.rmse, one.unit, 3)}"
        for one in outputs
    )
    remedy = (
        "give the port a smaller epsilon"
        if samples is None
        else f"over short horizons the smoothing matters less: try estimator.horizon={samples}"
    )
    return (
        f"the smoothing of sign(v) decides what was fitted ({said}): "
        f"the estimates are those of the smoothing; "
        f"{remedy}"
    )


def sentence(
    verdict: Verdict,
    estimate: Estimate,
    views: Sequence[View],
    astray: Sequence[View] = (),
    integrating: Sequence[View] = (),
) -> str:
    """The verdict in one line: whether to trust the estimates, and why. Of ``views``, those ``astray`` and
    ``integrating`` are free runs that leave far more than noise and simulation do, the latter by nature."""
    if verdict == "wrong":
        return "WRONG MODEL OR RECORD: the estimates are not to be trusted, and no standard error is stated"
    if verdict == "not_converged":
        return (
            f"NOT CONVERGED ({estimate.status}): these are no estimates but where the solver stopped, and no "
            "standard error is stated"
        )
    if verdict == "incomplete":
        return "incomplete: the errors ± are those of this model, and do not count what it lacks"
    untold = [one.output for one in estimate.left if math.isnan(one.noise)]
    if untold:
        outputs = " and ".join(untold)
        return (
            f"no fault found, but the records do not show the sensor's noise in {outputs}: how much less "
            "error a better model would leave is not known"
        )
    over = "" if views[0].horizon is None else f" {where(views[0])}"
    but = _undetermined(estimate) + _at_bound(estimate)
    but += _in_free_run("", astray, estimate.left)
    but += _in_free_run(", where small errors add up,", integrating, estimate.left)
    return f"sound{over}: the model leaves {_within_the_limit(estimate.left)}{but}"


def _undetermined(estimate: Estimate) -> str:
    """Which parameters the records do not determine; else empty."""
    names = [one.name for one in estimate.parameters if not one.identifiable]
    return f"; but the records do not determine {listed(names)}" if names else ""


def _at_bound(estimate: Estimate) -> str:
    """Which parameters the fit could not take further; else empty. A bound of zero is physics: a friction
    that is not there."""
    names = [one.name for one in estimate.parameters if one.at_bound and one.identifiable and one.value != 0]
    return f"; but {listed(names)} {'ends' if len(names) == 1 else 'end'} at a bound" if names else ""


def _in_free_run(how: str, astray: Sequence[View], left: Sequence[Left]) -> str:
    """How much the free runs ``astray`` leave; empty if there are none."""
    limits = {one.output: one.rmse / one.times for one in left}
    said = [f"{number(v.rmse / limits[v.output], 2)} times that of {v.output}" for v in astray]
    return f"; but in free run{how} it leaves {listed(said)}" if said else ""


def _within_the_limit(left: Sequence[Left]) -> str:
    """How much a sound fit leaves of the output that it leaves most of, beside noise and simulation. Where
    most of that is the model's own, its standard errors are too small."""
    more = [one for one in left if _two_digits(one.times) > 1.0]
    if not more:
        return "no more than noise and simulation do"
    worst = max(more, key=lambda one: one.times)
    said = f"{number(worst.times, 2)} times what noise and simulation leave of {worst.output}"
    rest = "; the errors ± do not count the rest, which hybridid trace looks for"
    return f"{said}, within the limit of {FAR:g}{rest if worst.times > MISFIT else ''}"


def _two_digits(share: float) -> float:
    return float(f"{share:.2g}")
