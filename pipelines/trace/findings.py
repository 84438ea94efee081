"""What a trace found, as the plain data of ``trace/trace.json``."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from hybridid.estimators import Estimate
from hybridid.model import Model
from hybridid.trace.ceiling import Ceiling
from hybridid.trace.refit import Refit
from hybridid.trace.robustness import Survival
from hybridid.trace.search import Accepted, Search, Step
from hybridid.trace.trial import PASSED, REJECTED, UNIDENTIFIABLE, Trial
from hybridid.trace.verdict import Trace

NORMAL_95 = 1.96
"""Half the width of a 95 % interval, in standard errors."""


def accepted_entries(found: Trace, estimate: Estimate) -> list[dict[str, Any]]:
    """One entry an accepted effect: its evidence when it was taken in, its parameters in the final model."""
    return [_accepted(one, _step_of(found.search, one), estimate) for one in found.accepted]


def rejected_entries(search: Search) -> list[dict[str, Any]]:
    """One entry an effect and port that was tried and not accepted, the largest gain first."""
    taken = {one.name for one in search.accepted}
    last: dict[str, tuple[int, Trial]] = {}
    for number, step in enumerate(search.steps, 1):
        last |= {trial.candidate.name: (number, trial) for trial in step.trials}
    entries = [
        {**_judged(search, trial), "step": number, **_tried(trial)}
        for name, (number, trial) in last.items()
        if name not in taken
    ]
    return sorted(entries, key=lambda e: -e["gain"])


def step_entries(search: Search) -> list[dict[str, Any]]:
    """Every trial of every step."""
    return [
        {
            "base": _scores(step.base),
            "accepted": step.accepted.name if step.accepted else None,
            "dropped": list(step.dropped),
            "trials": [
                {
                    "effect": t.candidate.effect.id,
                    "port": t.candidate.port,
                    "status": t.status,
                    "reason": t.reason,
                }
                | _tried(t)
                for t in sorted(step.trials, key=lambda t: -t.gain)
            ],
        }
        for step in search.steps
    ]


def path_entries(search: Search) -> list[dict[str, Any]]:
    """Held-out error over horizons, from the declared model to the last, at each change."""
    entries = [{"label": "declared model", **_scores(search.steps[0].base if search.steps else search.final)}]
    following = [*(step.base for step in search.steps[1:]), search.final]
    for step, after in zip(search.steps, following, strict=False):  # no step where the floor is met at once
        if step.accepted is not None:
            entries.append({"label": _change(step), **_scores(after)})
    return entries


def estimate_entries(estimate: Estimate) -> dict[str, dict[str, Any]]:
    """Estimates by name with their 95 % intervals."""
    return {
        p.name: {
            "value": p.value,
            "std": p.std,
            "unit": p.unit,
            "interval_95": [p.value - NORMAL_95 * p.std, p.value + NORMAL_95 * p.std],
            "at_bound": p.at_bound,
            "identifiable": p.identifiable,
            "meaning": p.meaning,
        }
        for p in estimate.parameters
    }


def ceiling_entry(found: Ceiling) -> dict[str, Any]:
    """A ceiling without its curve, which the figure shows."""
    kept = ("port", "over", "gain", "p_value", "unit", "over_unit")
    return {key: getattr(found, key) for key in kept}


def floor_entries(found: Trace, model: Model) -> dict[str, dict[str, Any]]:
    """The noise level of each output."""
    return {y.name: {"value": found.floor[y.name], "unit": y.unit} for y in model.outputs}


def _accepted(one: Accepted, number: int, estimate: Estimate) -> dict[str, Any]:
    trial, effect = one.trial, one.trial.candidate.effect
    prefix = f"{one.name}."
    own = {p.name.removeprefix(prefix): p for p in estimate.parameters if p.name.startswith(prefix)}
    known = {n.removeprefix(prefix): v for n, v in estimate.known.items() if n.startswith(prefix)}
    return {
        "effect": effect.id,
        "port": trial.candidate.port,
        "title": effect.title,
        "equation": effect.equation,
        "pattern": effect.pattern,
        "source": effect.source,
        "parameters": {n: {"value": p.value, "std": p.std, "unit": p.unit} for n, p in own.items()},
        "known": known,
        "class": list(dict.fromkeys(t.candidate.effect.id for t in one.alike)),
        "class_members": [
            {"effect": t.candidate.effect.id, "port": t.candidate.port} | _tried(t) for t in one.alike
        ],
        "separating_experiments": _separating(one),
        "p_value": trial.p_adjusted,
        "gain": trial.gain,
        "at_step": trial.own("values"),
        "likelihood_gain": trial.comparison.likelihood_gain if trial.comparison else None,
        "step": number,
        "survivals": [_survival(s) for s in one.survivals],
    }


def _survival(found: Survival) -> dict[str, Any]:
    short = {name.rsplit(".", 1)[-1]: value for name, value in found.parameters.items()}
    return {**asdict(found), "parameters": short}


def _judged(search: Search, trial: Trial) -> dict[str, Any]:
    """Status and reason at the end: what passed but was not taken is one of a class, or came too late."""
    about = {"effect": trial.candidate.effect.id, "port": trial.candidate.port}
    for one in search.accepted:
        if any(t.candidate == trial.candidate for t in one.alike):
            reason = f"explains these records as well as {one.name}: they cannot tell the two apart"
            return {**about, "status": UNIDENTIFIABLE, "reason": reason, "class_of": one.name}
    if trial.status == PASSED:
        reason = f"{trial.reason}, but less than what was accepted in its step; then {search.stopped}"
        return {**about, "status": REJECTED, "reason": reason}
    return {**about, "status": trial.status, "reason": trial.reason}


def _tried(trial: Trial) -> dict[str, Any]:
    found = trial.refit
    if found is None or trial.comparison is None:
        return {"gain": -1.0, "p_value": 1.0, "parameters": {}}
    prefix = f"{trial.candidate.name}."
    units = {p.name: p.unit for p in found.model.parameters}
    own = {
        name.removeprefix(prefix): {"value": value, "std": found.std.get(name), "unit": units[name]}
        for name, value in found.values.items()
        if name.startswith(prefix)
    }
    return {"gain": trial.gain, "p_value": trial.p_adjusted, "parameters": own, "seconds": found.seconds}


def _scores(base: Refit) -> dict[str, Any]:
    """Held-out and fitted RMSE over horizons by output, SI units."""
    names = [y.name for y in base.model.outputs]
    return {
        "held_out_rmse": dict(zip(names, base.score.rmse.tolist(), strict=True)),
        "fitted_rmse": dict(zip(names, base.fitted_rmse.tolist(), strict=True)),
        "loss": base.score.loss,
    }


def _change(step: Step) -> str:
    taken = f"+ {step.accepted.name}" if step.accepted else ""
    return ", ".join([taken, *(f"− {name}" for name in step.dropped)])


def _step_of(search: Search, one: Accepted) -> int:
    numbers = [
        k for k, step in enumerate(search.steps, 1) if step.accepted and step.accepted.name == one.name
    ]
    return numbers[-1] if numbers else 0


def _separating(one: Accepted) -> list[str]:
    """What to record so that the members of a class come apart."""
    asked = [t.candidate.effect.separating_experiment for t in one.alike] if len(one.alike) > 1 else []
    return list(dict.fromkeys(text for text in asked if text))
