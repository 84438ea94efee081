"""``judge``: a model, records and an estimate in, a ``Quality`` out.

1. What the fit leaves is set beside what doing nothing leaves, over its horizons and in free run.
2. Is it no more than the sensor's noise and the simulation leave (``estimators.floor``), nothing more is
asked. A free run that drifts by nature (``drift``) does not condemn a fit whose horizons are good. 3. Else
the records are asked which channels they confirm (``doubt``). For the others another sign, another unit and
another column are tried by real refits (``trial``); so is leaving the bounds that a parameter stands at.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybridid.advice import Advice, advise
from hybridid.advice.horizon import FEW, GROWN, GROWS
from hybridid.estimators.estimate import Estimate, Left
from hybridid.estimators.findings import several_valleys
from hybridid.estimators.fit import fit
from hybridid.estimators.floor import FAR
from hybridid.estimators.pieces import pieces
from hybridid.estimators.problem import Problem, build_problem
from hybridid.model import Model
from hybridid.quality.doubt import doubt_of
from hybridid.quality.drift import drifting, explained_over_horizons
from hybridid.quality.hypotheses import Hypothesis, hypotheses
from hybridid.quality.smoothing import steady_horizon
from hybridid.quality.trial import MOST_OF, Data, Trial, tried
from hybridid.quality.verdict import TRUSTED, WRONG, Finding, Quality, Verdict, View
from hybridid.quality.views import views_of
from hybridid.quality.words import (
    drifts,
    explained,
    explains_little,
    incomplete,
    sentence,
    smoothing_decides,
    too_long_steps,
    worse_than_nothing,
)
from hybridid.records.record import Record
from hybridid.simulation.windows import cut
from hybridid.validation.drift import growth, outputs_that_drift

Array = NDArray[np.float64]
PARTS = (20, 4, 1)
"""Of a record that a piece is: what is tried, one after the other."""
SAMPLES, FITS = 2000, 16
"""Samples of all pieces together, and how many fits they are used for."""
ALIKE = 2.0
"""Ratio of what two hypotheses leave up to which the records do not tell them apart."""
MUCH = 0.1
"""Share of the squared motion that a fit leaves, above which each record is asked alone."""
COARSE, MATTERS = 0.5, 0.01
"""Shares of what the fit and of what doing nothing leave, above which an error of the simulation is no
detail."""


def judge(
    model: Model, records: Sequence[Record], estimate: Estimate, held_out: Sequence[Record] = ()
) -> Quality:
    """The quality of ``estimate``, a fit of ``model`` to ``records``; there is advice about the range of the
    records ``held_out``, which it has not seen."""
    began = time.perf_counter()
    problem = _problem_of(model, records, estimate)
    views = views_of(model, records, estimate, problem)
    more = any(one.exceeded for one in estimate.left)
    unknown = any(math.isnan(one.noise) for one in estimate.left)
    drift = drifting(views, model, model.values(estimate.values), records)
    worse = [v for v in views if v.worse_than_nothing and v not in drift]
    bad = [v for v in worse if more or v.horizon == views[0].horizon]
    good = [] if any(v.horizon is not None for v in bad) else explained_over_horizons(views)
    findings = [Finding("worse_than_nothing", worse_than_nothing(bad, good))] if bad else []
    if bad or more or unknown:
        findings += _explanations(model, problem, estimate, bool(bad or more))
    findings += [*_steps(estimate, views), *_smoothing(problem, estimate, views)]
    if not findings and (more or unknown):
        findings += _incomplete(estimate, views)
    findings += [Finding("valley", said) for said in several_valleys(estimate.starts)]
    verdict = _verdict(estimate, findings)
    steady, integrating = _astray([v for v in views if v not in drift], model, estimate, records)
    said = sentence(verdict, estimate, views, steady, integrating)
    grows = growth(model, model.values(estimate.values), records) if drift else 0.0
    advice = [Advice("drift", drifts(drift, views[0], grows))] if drift and verdict != "wrong" else []
    if bad or more:
        advice += _otherwise_in_one(model, records, estimate, views)
    advice += advise(problem, estimate if verdict in TRUSTED else estimate.withheld(), held_out)
    return Quality(verdict, said, tuple(findings), views, time.perf_counter() - began, tuple(advice))


def _problem_of(model: Model, records: Sequence[Record], estimate: Estimate) -> Problem:
    """The problem of which ``estimate`` is the solution."""
    settings = estimate.settings
    return build_problem(
        model,
        records,
        settings.horizon,
        estimate.substeps,
        settings.initial_state == "estimated",
        integrator=settings.integrator,
    )


def _otherwise_in_one(
    model: Model, records: Sequence[Record], estimate: Estimate, views: Sequence[View]
) -> list[Advice]:
    """Which records alone say that a sign, a unit or a column is otherwise than declared, if some do and
    others do not: an amplifier that was plugged the other way round. Asked where much of the motion is left.
    """
    little = all(v.rmse**2 <= MUCH * v.nothing**2 for v in views)
    if little or len(records) < 2 or model.by_record or model.groups:
        return []
    settings = replace(estimate.settings, method="gauss_newton", starts=1)
    told = []
    for record in records:
        try:
            alone = fit(model, [record], settings)
        except ValueError:  # it shows no output, or cannot be fitted alone
            continue
        found = _explanations(model, _problem_of(model, [record], alone), alone, bounds=False)
        told += [f"of record {record.name} alone, {one.said}" for one in found]
    return [Advice("recordings", said) for said in told] if len(told) < len(records) else []


def _verdict(estimate: Estimate, findings: Sequence[Finding]) -> Verdict:
    if not estimate.converged:
        return "not_converged"
    if any(one.kind in WRONG for one in findings):
        return "wrong"
    return "incomplete" if any(one.kind == "incomplete" for one in findings) else "sound"


def _astray(
    views: Sequence[View], model: Model, estimate: Estimate, records: Sequence[Record]
) -> tuple[list[View], list[View]]:
    """The free runs beside good horizons that leave far more than noise and simulation do: of outputs that do
    not drift by nature, and of the others."""
    limits = {one.output: FAR * one.rmse / one.times for one in estimate.left if one.times > 0}
    found = [v for v in views[1:] if v.horizon is None and v.rmse > limits.get(v.output, math.inf)]
    if not found:
        return [], []
    drifts = outputs_that_drift(model, model.values(estimate.values), records)
    steady = {y.name for y, drift in zip(model.outputs, drifts, strict=True) if not drift}
    return [v for v in found if v.output in steady], [v for v in found if v.output not in steady]


def _steps(estimate: Estimate, views: Sequence[View]) -> list[Finding]:
    """That the fitted motion is too fast for the steps: with others the fit would be another one."""
    coarse = _decisive({one.output: one.step for one in estimate.left}, estimate, views)
    return [Finding("step", too_long_steps(coarse, estimate.substeps))] if coarse else []


def _smoothing(problem: Problem, estimate: Estimate, views: Sequence[View]) -> list[Finding]:
    """That the smoothing of sign(v) decides: with another width the fit would be another one."""
    smeared = {one.output: one.smeared for one in estimate.left}
    decided = _decisive(smeared, estimate, views)
    if not decided:
        return []
    return [Finding("smoothing", smoothing_decides(decided, steady_horizon(problem, estimate)))]


def _decisive(errors: Mapping[str, float], estimate: Estimate, views: Sequence[View]) -> list[Left]:
    """Outputs of which an error of the simulation is no detail, beside what is left and beside the motion."""
    nothing = {v.output: v.nothing for v in views}
    return [
        one
        for one in estimate.left
        if errors[one.output] > max(COARSE * one.rmse, MATTERS * nothing[one.output])
    ]


def _incomplete(estimate: Estimate, views: Sequence[View]) -> list[Finding]:
    """That physics is missing: more is left than noise and simulation leave, or most of the motion where the
    records do not tell the noise."""
    if any(one.exceeded for one in estimate.left):
        return [Finding("incomplete", incomplete(estimate.left))]
    untold = {one.output for one in estimate.left if math.isnan(one.noise)}
    little = [v for v in views if v.output in untold and not v.rmse**2 < MOST_OF * v.nothing**2]
    return [Finding("incomplete", explains_little(little))] if little else []


def _explanations(model: Model, problem: Problem, estimate: Estimate, bounds: bool) -> list[Finding]:
    """The hypothesis that explains most of what the fit leaves, with those that the records do not tell from
    it; none if nothing explains it. ``bounds``: those that a parameter stands at are released too.

    Only channels that the fit does not confirm are asked about. Short pieces are tried first: a longer run
    tells more, where its cost does not have many valleys. Where the model is unstable, pieces are so short
    that an error grows by e to the power of ``GROWS`` at most: over longer ones any reading that makes it
    stable is better.
    """
    p, guess = model.values(estimate.values), model.values()
    at_bound = [q.name for q in estimate.parameters if q.at_bound] if bounds else []
    doubted = np.flatnonzero(doubt_of(Data.of(problem), p, estimate.initial_states).channels).tolist()
    asked = [one for one in hypotheses(model, problem.records, at_bound) if one.concerns(doubted)]
    problem = _before_it_falls(problem, p)
    for parts in PARTS if asked else ():
        data = Data.of(pieces(problem, parts, SAMPLES, FITS))
        given = tried(data, [p, guess])
        kept = _kept(asked, given, guess, p)
        if kept:
            named = [one.hypothesis for one in kept if one.hypothesis is not None]
            return [Finding(named[0].kind, explained(named, kept[0], given))]
    return []


def _before_it_falls(problem: Problem, p: Array) -> Problem:
    """``problem`` over horizons so short that an error of an unstable model stays small at ``p`` (n_p,)."""
    rate, old = growth(problem.model, p, problem.records), problem.windows
    if rate * max(old.lengths) * old.dt <= GROWN:
        return problem
    windows = cut(problem.records, max(FEW, round(GROWS / rate / old.dt)), old.substeps)
    return replace(problem, windows=windows, shooter=problem.shooter.over(windows), estimate_x0=True)


def _kept(asked: Sequence[Hypothesis], given: Trial, guess: Array, p: Array) -> list[Trial]:
    """Of the hypotheses that explain most of what ``given`` leaves the best, and those like it. They are
    fitted from ``guess``; without the bounds where the fit stands, from there (``p``)."""
    most = MOST_OF * min(given.share, 1.0)
    starts = [p if one.released else guess for one in asked]
    found = [tried(given.data.under(h, q), [q], h, most) for h, q in zip(asked, starts, strict=True)]
    kept = [one for one in found if one.explains(given)]
    best = min((one.share for one in kept), default=0.0)
    alike = [one for one in kept if one.share <= ALIKE * best]
    return sorted(alike, key=lambda one: (bool(one.hypothesis and one.hypothesis.released), one.share))
