"""Whether an effect has the same amplitude in the held-out records as in the fitted ones.

A law of physics keeps its amplitude from record to record of one machine. A law that only resembles what is
missing takes another amplitude in each record. So the whole model is fitted once more, to the held-out
horizons alone. With a +- s an amplitude where the trace fits, and a' +- s' where it judges, the amplitude has
moved if

    |a - a'| > steady min(|a|, |a'|)   and   2 (1 - Phi(|a - a'| / sqrt(s^2 + s'^2))) <= alpha / n,

n being the number of the effect's amplitudes. The first condition is on the size of the change
(``Rules.steady``), the second on its significance. Both fits must have converged. Amplitudes of one unit are
compared with the largest of them: relative to itself, one near zero would move by a large share. The standard
errors are those of coloured residuals, so they include the share of what the model does not explain. An
amplitude that ends at nothing, its bound, has no standard error: that of the other records stands for it. The
stiffness of a limit is excepted: the records may only tell that it is large.

Where two effects explain the errors equally well, this test may still tell them apart: it compares how each
record leads to the error.

Source: Chow (1960), Tests of equality between sets of coefficients in two linear regressions, Econometrica
28(3), 591-605; Peters, Buhlmann, Meinshausen (2016), Causal inference by using invariant prediction,
J. Royal Statistical Society B 78(5), 947-1012.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from scipy.stats import norm

from hybridid.estimators.uncertainty import uncertainty
from hybridid.naming import listed
from hybridid.quantities import estimated
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules

NOTHING = 1e-3
"""Share of an amplitude in the other records up to which one is nothing."""
NO_CONSTANT = "its amplitude is no constant"
"""Begins the reason for which an effect is refused here."""


@dataclass(frozen=True)
class Amplitude:
    """An amplitude in ``unit`` with its standard error: ``here`` in the fitted records, ``there`` in the
    held-out ones. ``size`` is the smaller of the effect's largest amplitudes of that unit here and there."""

    name: str
    unit: str
    here: tuple[float, float]
    there: tuple[float, float]
    size: float

    @property
    def p_value(self) -> float:
        """Of one amplitude in both; 1 where a standard error is not known."""
        error = math.hypot(_error(self.here, self.there), _error(self.there, self.here))
        if not (math.isfinite(error) and error > 0):
            return 1.0
        return float(2 * norm.sf(abs(self.here[0] - self.there[0]) / error))

    @property
    def moved(self) -> float:
        """By which share of its size it differs."""
        return abs(self.here[0] - self.there[0]) / max(self.size, 1e-300)

    def __str__(self) -> str:
        return (
            f"{self.name} = {estimated(*self.here, self.unit)} in the fitted records, "
            f"{estimated(*self.there, self.unit)} in those held out"
        )


def _error(one: tuple[float, float], other: tuple[float, float]) -> float:
    """The standard error of ``one`` amplitude; where it is nothing, and has none, that of the ``other``."""
    value, std = one
    return std if math.isfinite(std) or abs(value) > NOTHING * abs(other[0]) else other[1]


def fitted_to_held_out(fitted: Sequence[Refit], context: Context) -> list[Refit | None]:
    """Each model, fitted to the held-out horizons alone; None if it cannot be simulated there."""
    there = context.split.swapped
    given = [(one.model, there, [one.values], one, one.numerics, math.inf) for one in fitted]
    return context.each("fitted to the other horizons", refit_if_possible, given)


def told_of_held_out(final: Refit, context: Context) -> Refit | None:
    """``final``, fitted to the held-out horizons alone, as it is told beside the last fit.

    Its standard errors hold what the smoothing of sign(v) moves the parameters by. None if it cannot be
    simulated there.
    """
    (there,) = fitted_to_held_out([final], context)
    return there and context.one(with_smoothing, there, context.split.swapped)


def with_smoothing(fitted: Refit, split: Split) -> Refit:
    """``fitted`` on ``split``, whose standard errors hold what the smoothing of sign(v) moves the parameters
    by; none where it has none."""
    problem, rows = fitted.problem(split).on(split.fitted), list(split.fitted)
    found = uncertainty(problem, fitted.model.values(fitted.values), fitted.x0[rows])
    std = dict(zip(problem.free, found.std.tolist(), strict=True))
    return replace(fitted, std=std if fitted.std else {})


def amplitudes(here: Refit, there: Refit, term: str) -> tuple[Amplitude, ...]:
    """The amplitudes of the effect ``term``, in the same model fitted ``here`` and ``there``."""
    own = next(one for one in here.model.terms if one.name == term)
    names = [f"{term}.{p.name}" for p in own.effect.parameters if p.nests and not p.fixed and not p.hard]
    units = {p.name: p.unit for p in here.model.parameters}

    def largest(fitted: Refit, unit: str) -> float:
        return max(abs(fitted.values[name]) for name in names if units[name] == unit)

    def both(fitted: Refit, name: str) -> tuple[float, float]:
        return fitted.values[name], fitted.std.get(name, math.nan)

    return tuple(
        Amplitude(
            name.rsplit(".", 1)[-1],
            units[name],
            both(here, name),
            both(there, name),
            min(largest(here, units[name]), largest(there, units[name])),
        )
        for name in names
        if name in units
    )


def moved(here: Refit, there: Refit | None, term: str, rules: Rules) -> str:
    """Which amplitudes of the effect ``term`` have moved from ``here`` to ``there``, in words; else empty."""
    if there is None or not (here.converged and there.converged):
        return ""
    found = amplitudes(here, there, term)
    told = [str(a) for a in found if a.moved > rules.steady and len(found) * a.p_value <= rules.alpha]
    return f"{NO_CONSTANT}: {listed(told)}" if told else ""
