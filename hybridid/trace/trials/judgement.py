"""``judge``: which of the trials of a step pass.

A trial passes if its held-out gain is worth having, significant with all that was tried counted, and the
records determine the effect's own parameters.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy import stats

from hybridid.declarations import Parameter
from hybridid.effects.effect import EffectParameter
from hybridid.quantities import change, estimated, percent, quantity
from hybridid.trace.horizons.evidence import holm
from hybridid.trace.rules import Rules
from hybridid.trace.trials.trial import PASSED, REJECTED, UNIDENTIFIABLE, UNTRIED, Trial

ORDER = 1.0
"""Standard error, as a share of the value, up to which the records tell the order of magnitude of a parameter
that cannot be zero (a time constant, a width): the interval of its logarithm then ends within a factor of 7.5
to either side. That it is not zero is no question."""
NOT_SIGNIFICANT = "not significant"
"""How the reason begins why a trial whose gain is worth having is refused for its p-value."""
WELL_KNOWN = 0.05
"""Standard error, as a share of the value, up to which a parameter is known whatever it is collinear with."""


def judge(trials: Sequence[Trial], rules: Rules, family: int = 0) -> list[Trial]:
    """Give every trial its status and reason.

    All tried together are one family, weighted by what each takes from the fitted horizons: what does
    nothing there needs no share of the error allowed. No held-out horizon has a part in the weights.

    If held-out horizons told which to try, all of the ``family`` count that could have been tried, with equal
    weights (Bonferroni).
    """
    p_values = [t.comparison.p_value if t.comparison else 1.0 for t in trials]
    if family:
        adjusted = [min(1.0, p * family) for p in p_values]
    else:
        adjusted = holm(p_values, [t.fitted_gain for t in trials])
    return [decided_at(t, p, rules) for t, p in zip(trials, adjusted, strict=True)]


def decided_at(trial: Trial, p: float, rules: Rules) -> Trial:
    """``trial`` with its status and reason, where ``p`` is its adjusted p-value."""
    trial = replace(trial, p_adjusted=p)
    if trial.comparison is None:
        return replace(trial, status=UNTRIED, reason=f"could not be fitted: {trial.failure}")
    gain = trial.comparison.gain
    ended = "; its refit promised little and ended early" if trial.refit and trial.refit.ended_early else ""
    if gain < rules.worth:
        return replace(
            trial,
            status=REJECTED,
            reason=f"{too_little(gain, rules)}{ended}",
        )
    if ended:
        return replace(
            trial, status=REJECTED, reason="it promised less than what it was to replace, and ended early"
        )
    if p > rules.alpha:
        return replace(
            trial, status=REJECTED, reason=f"{NOT_SIGNIFICANT}: adjusted p = {p:.2g} over {rules.alpha:g}"
        )
    vague = trial.not_shown or undetermined(trial, rules)
    if vague:
        return replace(trial, status=UNIDENTIFIABLE, reason=vague)
    return replace(trial, status=PASSED, reason=f"held-out RMSE {gain:.1%} lower, adjusted p = {p:.2g}")


def too_little(gain: float, rules: Rules) -> str:
    """That ``gain``, a share of the held-out RMSE, is less than what is asked, in words."""
    return f"held-out RMSE changes by {change(1.0, 1.0 - gain)}; {percent(rules.worth)} less is asked"


def undetermined(trial: Trial, rules: Rules) -> str:
    """Why the effect's own parameters are not determined, or nothing if they are.

    The likelihood of a ``hard`` amplitude may be flat towards infinity: then its standard error is large,
    though zero is excluded. That it is not zero is what the held-out gain shows.
    """
    assert trial.refit is not None
    values, errors = trial.own("values"), trial.own("std")
    units = {p.name: p.unit for p in trial.refit.model.parameters}

    def said(name: str) -> str:
        unit = units[f"{trial.candidate.name}.{name}"]
        return f"{name} = {estimated(values[name], errors[name], unit)}"

    amplitudes = _amplitudes(trial)
    each = [[name] for name in amplitudes] if trial.candidate.effect.sum_of else [amplitudes]
    vague = [name for names in each if not _stand_off_nothing(trial, names, rules) for name in names]
    if vague and not _is_hard(trial):
        return f"{', '.join(map(said, vague))}: not determined by these records"
    into = trial.candidate.effect.into
    if into and not _stand_off_nothing(trial, [into], rules):
        return f"{said(into)}: nothing is shown to enter the second level"
    for p, declared in _judged_alone(trial):
        value, std = values[p.name], errors[p.name]
        most = ORDER if declared.lower > 0 else rules.vague
        if not math.isfinite(std) or (not p.nests and std > most * max(abs(value), declared.scale)):
            return f"{said(p.name)}: not determined by these records"
    return _degenerate(trial) or _collinear(trial, rules)


def _degenerate(trial: Trial) -> str:
    """Which of the effect's own parameters ends at its bound, where its form is lost; empty if none."""
    assert trial.refit is not None
    values = trial.own("values")
    for p, declared in _judged_alone(trial):
        value = values[p.name]
        span = 1e-3 * max(abs(value), 1e-3 * declared.scale)
        if value <= declared.lower + span or value >= declared.upper - span:
            return _at_bound(p.name, value, declared)
    port = trial.refit.model.plant.port(trial.candidate.port)
    lost = ((p.name, p.at(port)) for p in trial.candidate.effect.parameters if p.lost_above)
    return next((_at_bound(n, values[n], d) for n, d in lost if values[n] >= (1 - 1e-3) * d.upper), "")


def _at_bound(name: str, value: float, declared: Parameter) -> str:
    return f"{name} = {quantity(value, declared.unit, 4)} ends at its bound: the effect degenerates"


def _amplitudes(trial: Trial) -> list[str]:
    return [p.name for p in trial.candidate.effect.parameters if p.nests and not p.fixed]


def _is_hard(trial: Trial) -> bool:
    return any(p.hard for p in trial.candidate.effect.parameters)


def _judged_alone(trial: Trial) -> Iterator[tuple[EffectParameter, Parameter]]:
    """The effect's own parameters that matter one by one, with their bounds at the port: not a ``hard`` one;
    several amplitudes are judged together."""
    assert trial.refit is not None
    port = trial.refit.model.plant.port(trial.candidate.port)
    several = len(_amplitudes(trial)) > 1
    for p in trial.candidate.effect.parameters:
        declared = p.at(port)
        if not (declared.fixed or p.minor or p.hard or (p.nests and several)):
            yield p, declared


def _stand_off_nothing(trial: Trial, amplitudes: Sequence[str], rules: Rules) -> bool:
    """Whether the amplitudes together are as unlikely to be nothing as one whose standard error is
    ``rules.vague`` of its value. Of several the largest stands off by chance more often, so more is asked of
    these: the square of their strength is chi-squared, with as many degrees of freedom as there are."""
    likely = stats.chi2.sf(_strength(trial, amplitudes) ** 2, max(len(amplitudes), 1))
    return bool(likely <= stats.chi2.sf(rules.vague**-2, 1))


def _strength(trial: Trial, amplitudes: Sequence[str]) -> float:
    """How many standard errors the effect's amplitudes together stand off nothing (Wald)."""
    assert trial.refit is not None
    names = [f"{trial.candidate.name}.{name}" for name in amplitudes]
    rows = [list(trial.refit.std).index(name) for name in names]
    std = np.array([trial.refit.std[name] for name in names])
    if not np.isfinite(std).all():
        return 0.0
    value = np.array([trial.refit.values[name] for name in names])
    covariance = trial.refit.correlation[np.ix_(rows, rows)] * np.outer(std, std)
    square = float(value @ np.linalg.pinv(covariance) @ value)  # without the smoothing, maybe indefinite
    return math.sqrt(max(0.0, square))


def _collinear(trial: Trial, rules: Rules) -> str:
    """Which parameter of the model is collinear with one of the effect's own that is not known well all the
    same; empty if none.

    A correlation says that the errors of two parameters go together, not that they are large: what the
    records tell of a parameter beside all others is its standard error (Belsley, Kuh, Welsch 1980, Regression
    Diagnostics, ch. 3). Of a load behind a spring, as heavy as the machine, the sum of both inertias may be
    known to a hundredth of a per cent, and each to a fifth of one: there the correlation is over 0.999.
    """
    assert trial.refit is not None
    names, std, values = list(trial.refit.std), trial.refit.std, trial.refit.values
    own = [k for k, name in enumerate(names) if name.startswith(f"{trial.candidate.name}.")]
    others = [k for k in range(len(names)) if k not in own]
    for k in own:
        if std[names[k]] <= WELL_KNOWN * abs(values[names[k]]):
            continue
        for j in others:
            if abs(trial.refit.correlation[k, j]) > rules.collinear:
                return f"{names[k].rsplit('.', 1)[-1]} cannot be told from {names[j]} in these records"
    return ""


def is_nothing(trial: Trial) -> bool:
    """Whether the effect's amplitudes together are less than one standard error in its refit: then its model
    is the one without it. False where no standard errors were asked for."""
    amplitudes = _amplitudes(trial)
    return bool(amplitudes and trial.refit and trial.refit.std and _strength(trial, amplitudes) < 1.0)


def differs_from_zero(trial: Trial, rules: Rules) -> bool:
    """Whether the effect's amplitudes together differ significantly from zero in its refit (Wald)."""
    amplitudes = _amplitudes(trial)
    if not (amplitudes and trial.refit and trial.refit.std):
        return False
    return bool(stats.chi2.sf(_strength(trial, amplitudes) ** 2, len(amplitudes)) <= rules.alpha)
