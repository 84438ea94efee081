"""``Trial``: one candidate, refitted and judged."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from hybridid.declarations import Parameter
from hybridid.effects.effect import EffectParameter
from hybridid.model import Model
from hybridid.trace.candidates import Candidate
from hybridid.trace.evidence import Comparison, compare, holm
from hybridid.trace.numerics import Numerics
from hybridid.trace.periodic import not_shown
from hybridid.trace.refit import (
    FAILURES,
    LEAST_DECREASE,
    Refit,
    begun_at_the_record,
    least_of,
    refit,
    refit_beside,
)
from hybridid.trace.rules import Rules
from hybridid.trace.shorter import from_shorter, same_valley
from hybridid.trace.solve import by_either_integrator
from hybridid.trace.sought import known_means, sought
from hybridid.trace.split import Split

PASSED, REJECTED, UNIDENTIFIABLE, UNTRIED = "passed", "rejected", "unidentifiable", "untried"


@dataclass(frozen=True)
class Trial:
    """A candidate's refit, its evidence over the model without it, and what was decided.

    ``fitted_gain`` is the share that it takes from the squared error of the fitted horizons. ``failure`` says
    why it could not be fitted, ``not_shown`` why the records cannot show its form. ``seconds`` are those of
    all its refits, with both integrators.
    """

    candidate: Candidate
    refit: Refit | None
    comparison: Comparison | None
    fitted_gain: float = 1.0
    p_adjusted: float = 1.0
    status: str = REJECTED
    reason: str = ""
    failure: str = ""
    not_shown: str = ""
    seconds: float = 0.0

    @property
    def gain(self) -> float:
        """Relative decrease of the held-out loss; minus infinity without a comparison."""
        return self.comparison.gain if self.comparison else -math.inf

    @property
    def taken(self) -> float:
        """What the effect takes from the held-out squared error, over the outputs' variances."""
        if self.refit is None or not math.isfinite(self.gain):
            return 0.0
        after = self.refit.score.loss**2
        return after / (1.0 - self.gain) ** 2 - after

    def own(self, quantity: str) -> dict[str, float]:
        """The effect's own ``values`` or ``std`` by short name; a known constant has no std."""
        assert self.refit is not None
        table, prefix = getattr(self.refit, quantity), f"{self.candidate.name}."
        return {name.removeprefix(prefix): value for name, value in table.items() if name.startswith(prefix)}


@np.errstate(over="ignore", invalid="ignore")  # a start may diverge
def attempt(
    candidate: Candidate,
    base: Refit,
    split: Split,
    worth: float = Rules.worth,
    rival: Refit | None = None,
) -> Trial:
    """Add the candidate to the base model, refit everything, compare on held-out horizons.

    A refit that promises little ends early: less than ``LEAST_DECREASE``, and than half of ``worth``, of the
    fitted cost and of the held-out RMSE of ``base``, or of a ``rival`` that it is to replace. One that takes
    so little of the RMSE of ``base`` has no standard errors.

    What is too stiff for the integrator of ``base`` is tried again with the implicit one: the starts that it
    could not solve, or all if the end is too stiff. That trial counts if it explains more: else everything
    that follows would be solved the slow way for nothing.
    """
    began = time.perf_counter()
    trial = _solved(candidate, base, split, least_of(worth), rival)
    return replace(trial, seconds=time.perf_counter() - began)


def _solved(candidate: Candidate, base: Refit, split: Split, least: float, rival: Refit | None) -> Trial:
    """The trial by the integrator of ``base``, or by the implicit one where that is needed and better."""

    def solve(numerics: Numerics, to_beat: Refit, chosen: Sequence[int] | None) -> Trial:
        lowest = min(filter(None, (to_beat, rival)), key=lambda one: one.cost)
        return _attempt(candidate, base, split, numerics, lowest, least, chosen)

    return by_either_integrator(solve, base)


def _attempt(
    candidate: Candidate,
    base: Refit,
    split: Split,
    numerics: Numerics,
    to_beat: Refit,
    least: float,
    chosen: Sequence[int] | None = None,
) -> Trial:
    """The trial from all starts, or from the ``chosen`` ones by number; ``to_beat`` and ``least`` as in
    ``refit_if_hopeful``."""
    model: Model = candidate.added_to(base.model)
    try:
        known = known_means(candidate, model, split)
        starts = [*candidate.starts(model, base.values), *sought(candidate, model, base, split)]
        starts = [{**starts[k], **known} for k in (range(len(starts)) if chosen is None else chosen)]
        found = refit_beside(base, model, split, starts, numerics, to_beat, least)
        found = _begun_anew(found, base, split) if found.converged else found
        found = _unless_better_from_shorter(found, candidate, base, split, least)
    except (ValueError, ArithmeticError) as error:
        return Trial(candidate, None, None, failure=str(error))
    if not math.isfinite(found.cost):
        return Trial(candidate, None, None, failure="the simulation diverges from every start")
    evidence = compare(base.score, found.score)
    fitted_gain = max(0.0, 1.0 - found.cost / base.cost) if base.cost > 0 else 0.0
    return Trial(candidate, found, evidence, fitted_gain, not_shown=not_shown(candidate, found, split))


def _begun_anew(found: Refit, base: Refit, split: Split) -> Refit:
    """``found``, or its refit with the initial states that the record shows, if it diverges held out.

    The initial states of ``base`` are lent. Where the effect makes the held-out motion unstable (a damping
    that becomes negative), horizons that begin a little beside the record diverge, though the model is right.
    """
    if math.isfinite(found.score.loss):
        return found
    begun = begun_at_the_record(base, base.values, split)
    return refit(found.model, split, [found.values], begun, found.numerics)


def _unless_better_from_shorter(
    found: Refit, candidate: Candidate, base: Refit, split: Split, least: float
) -> Refit:
    """``found``, or the refit from where shorter horizons end, if that explains more. That start is fitted as
    sharply as the model is declared, so it is not led there through wider smoothings."""
    shorter = from_shorter(candidate, found.model, base, split)
    if shorter is None or same_valley(candidate, shorter[0], found.values):
        return found
    start, begun = shorter
    try:
        again = refit(
            found.model, split, [start], begun, found.numerics, std_up_to=(1 - least) * base.score.loss
        )
    except FAILURES:
        return found
    return again if again.cost < (1 - LEAST_DECREASE) * found.cost else found


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
    return [_decided(replace(t, p_adjusted=p), rules) for t, p in zip(trials, adjusted, strict=True)]


def _decided(trial: Trial, rules: Rules) -> Trial:
    if trial.comparison is None:
        return replace(trial, status=UNTRIED, reason=f"could not be fitted: {trial.failure}")
    gain, p = trial.comparison.gain, trial.p_adjusted
    ended = "; its refit promised little and ended early" if trial.refit and trial.refit.ended_early else ""
    if gain < rules.worth:
        return replace(
            trial,
            status=REJECTED,
            reason=f"held-out RMSE changes by {-gain:+.1%}; {rules.worth:.0%} less is asked" + ended,
        )
    if ended:
        return replace(
            trial, status=REJECTED, reason="it promised less than what it was to replace, and ended early"
        )
    if p > rules.alpha:
        return replace(
            trial, status=REJECTED, reason=f"not significant: adjusted p = {p:.2g} over {rules.alpha:g}"
        )
    vague = trial.not_shown or undetermined(trial, rules)
    if vague:
        return replace(trial, status=UNIDENTIFIABLE, reason=vague)
    return replace(trial, status=PASSED, reason=f"held-out RMSE {gain:.1%} lower, adjusted p = {p:.2g}")


def undetermined(trial: Trial, rules: Rules) -> str:
    """Why the effect's own parameters are not determined, or nothing if they are."""
    assert trial.refit is not None
    values, errors = trial.own("values"), trial.refit.std
    amplitudes = _amplitudes(trial)
    if _strength(trial, amplitudes) * rules.vague < 1.0:
        said = ", ".join(
            f"{n} = {values[n]:.3g} ± {errors[f'{trial.candidate.name}.{n}']:.2g}" for n in amplitudes
        )
        return f"{said}: not determined by these records"
    for p, declared in _judged_alone(trial):
        value, std = values[p.name], errors[f"{trial.candidate.name}.{p.name}"]
        if not math.isfinite(std) or (not p.nests and std > rules.vague * max(abs(value), declared.scale)):
            return f"{p.name} = {value:.4g} ± {std:.2g} {declared.unit} is not determined by these records"
    return _degenerate(trial) or _collinear(trial, rules)


def _degenerate(trial: Trial) -> str:
    """Which of the effect's own parameters ends at its bound, where its form is lost; empty if none."""
    values = trial.own("values")
    for p, declared in _judged_alone(trial):
        value = values[p.name]
        span = 1e-3 * max(abs(value), 1e-3 * declared.scale)
        if value <= declared.lower + span or value >= declared.upper - span:
            return f"{p.name} = {value:.4g} {declared.unit} ends at its bound: the effect degenerates"
    return ""


def _amplitudes(trial: Trial) -> list[str]:
    return [p.name for p in trial.candidate.effect.parameters if p.nests and not p.fixed]


def _judged_alone(trial: Trial) -> Iterator[tuple[EffectParameter, Parameter]]:
    """The effect's own parameters that matter one by one, with their bounds at the port; several
    amplitudes are judged together."""
    assert trial.refit is not None
    port = trial.refit.model.plant.port(trial.candidate.port)
    several = len(_amplitudes(trial)) > 1
    for p in trial.candidate.effect.parameters:
        declared = p.at(port)
        if not (declared.fixed or p.minor or (p.nests and several)):
            yield p, declared


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
    return float(np.sqrt(value @ np.linalg.pinv(covariance) @ value))


def _collinear(trial: Trial, rules: Rules) -> str:
    """Which parameter of the model is collinear with one of the effect's own; empty if none."""
    assert trial.refit is not None
    names = list(trial.refit.std)
    own = [k for k, name in enumerate(names) if name.startswith(f"{trial.candidate.name}.")]
    others = [k for k in range(len(names)) if k not in own]
    for k in own:
        for j in others:
            if abs(trial.refit.correlation[k, j]) > rules.collinear:
                return f"{names[k].rsplit('.', 1)[-1]} cannot be told from {names[j]} in these records"
    return ""


def differs_from_zero(trial: Trial, rules: Rules) -> bool:
    """Whether the effect's amplitudes together differ significantly from zero in its refit (Wald)."""
    amplitudes = _amplitudes(trial)
    if not (amplitudes and trial.refit and trial.refit.std):
        return False
    return bool(stats.chi2.sf(_strength(trial, amplitudes) ** 2, len(amplitudes)) <= rules.alpha)


def equivalents(best: Trial, trials: Sequence[Trial], rules: Rules) -> list[Trial]:
    """The trials that held-out horizons cannot tell from ``best``, itself first.

    Beside those that passed, these are the determined ones whose gain alone is not significant, if they take
    at least half of what ``best`` takes: not to be shown better than nothing is not to be shown worse than
    ``best``. (Hansen, Lunde, Nason (2011), The model confidence set, Econometrica 79(2), 453-497.)

    Two effects are one class if the advantage of the better one is not significant, or less than
    ``rules.tie`` of the error. Declared look-alikes are one class also if it is less than ``rules.tie`` of
    what the better one takes from the squared error. (Bouc-Wen hysteresis contains Dahl's friction and has
    one shape parameter more, which always lowers the error a little.)
    """
    others = [t for t in trials if t is not best and (t.status == PASSED or _insignificant(t, best, rules))]
    return [
        best,
        *(t for t in others if indistinguishable(best, t, rules) or _nearly_alike(best, t, rules)),
    ]


def _insignificant(trial: Trial, best: Trial, rules: Rules) -> bool:
    """Whether only significance refused the trial, which takes at least half of what ``best`` takes."""
    only = trial.status == REJECTED and trial.gain >= rules.worth and trial.p_adjusted > rules.alpha
    return only and 2 * trial.taken >= best.taken and not (trial.not_shown or undetermined(trial, rules))


def _nearly_alike(best: Trial, other: Trial, rules: Rules) -> bool:
    left, more = (1.0 - best.gain) ** 2, (1.0 - other.gain) ** 2
    return look_alikes(best, other) and more - left < rules.tie * (1.0 - left)


def look_alikes(one: Trial, other: Trial) -> bool:
    """Whether one effect is declared to look like the other."""
    ours, theirs = one.candidate.effect, other.candidate.effect
    return ours.id in theirs.look_alikes or theirs.id in ours.look_alikes


def related(one: Trial, other: Trial) -> bool:
    """Whether both are the same law, perhaps at several ports, or declared look-alikes."""
    return one.candidate.effect.id == other.candidate.effect.id or look_alikes(one, other)


def indistinguishable(best: Trial, other: Trial, rules: Rules) -> bool:
    """Whether held-out horizons show no relevant advantage of ``best``."""
    assert best.refit is not None
    assert other.refit is not None
    advantage = compare(other.refit.score, best.refit.score)
    return advantage.gain < rules.tie or advantage.p_value > rules.alpha
