"""A stored trace, made up: every entry that a page or the terminal prints."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from hybridid.trace.entries import (
    AcceptedEffect,
    EstimatedValue,
    Floor,
    LearnedGain,
    Level,
    StepTaken,
    TriedEffect,
    UsedRecord,
    Value,
)
from hybridid.trace.results.before_after import ScoreRow
from hybridid.trace.results.completeness import Completeness
from hybridid.trace.results.result import Estimates, LearnedGains, Trace
from hybridid.trace.rules import Rules
from hybridid.trace.trials.robustness import Survival
from pipelines.shared.traced import TraceFile

NAN = math.nan


def _row(model: str, role: str, horizon: float | None, rmse: float, **more: Any) -> ScoreRow:
    view = "free_run" if horizon is None else "horizon"
    row = ScoreRow(
        model, role, "position", view, rmse**2, rmse, 0.99, 90.0, 100, "m", "simulated", horizon,
        role=role, network=False, mae=0.8 * rmse,
    )  # fmt: skip
    return replace(row, **more)


def _tried(effect: str, gain: float, status: str = "rejected", **more: Any) -> TriedEffect:
    value = {"k": Value(1.0, 0.1, "N/m")}
    return replace(TriedEffect(effect, "cart", status, "its reason", 1, gain, 0.5, value, 1.0), **more)


def _survival(name: str, **more: Any) -> Survival:
    return replace(Survival(name, 0.4, 0.98, 1e-6, {"f_c": 2.1}, refuted=False, survives=True), **more)


ACCEPTED = AcceptedEffect(
    effect="coulomb",
    port="cart",
    title="Coulomb friction",
    equation="F = f_c sign(v)",
    pattern="constant <against> the motion",
    source="a textbook",
    parameters={"f_c": Value(2.0, 0.05, "N")},
    known={},
    alike=("coulomb", "dahl"),
    class_members=(_tried("coulomb", 0.5, "passed"), _tried("dahl", 0.49, "passed")),
    separating_experiments=("slow reversals",),
    p_value=1e-6,
    gain=0.5,
    at_step={"f_c": 1.98},
    likelihood_gain=100.0,
    step=1,
    survivals=(
        _survival("epsilon x 3"),
        _survival("half the step", survives=False, kept=0.1),
        _survival("inputs foh", refuted=True),
        _survival("integrator rodas3", simulated=False, parameters={}),
    ),
)

FOUND = Trace(
    provenance="simulated",
    verdict="ambiguous",
    sentence="The model lacked a friction.",
    cautions=("Beware: it may be another one.", "Free runs say nothing."),
    accepted=(ACCEPTED,),
    rejected=(_tried("stribeck", 0.6, "unidentifiable"), _tried("backlash", -1.0)),
    before=(
        _row("gray box", "fitted", None, 2e-3),
        _row("gray box", "fitted", 1.0, 1e-3),
        _row("gray box", "held out", 1.0, 1.2e-3),
    ),
    after=(
        _row("gray box + effects", "fitted", None, NAN, mse=NAN, r2=NAN, remark="diverges at 2 s"),
        _row("gray box + effects", "fitted", 1.0, 5e-4),
        _row("gray box + effects", "held out", 1.0, 6e-4),
    ),
    noise_floor={"position": Floor(1e-6, "m")},
    seconds=12.0,
    declared=("cart.viscous",),
    effects=("cart.viscous", "cart.coulomb"),
    estimates=Estimates(
        {"M": EstimatedValue(10.0, 0.5, "kg", (9.0, 11.0), False, True, "mass")},
        {
            "M": EstimatedValue(9.5, NAN, "kg", (NAN, NAN), False, False, "mass"),
            "cart.coulomb.f_c": EstimatedValue(2.0, 0.05, "N", (1.9, 2.1), True, True, "level"),
        },
    ),
    path=(
        Level("declared model", {"position": 1.2e-3}, {"position": 1e-3}, 0.1),
        Level("+ cart.coulomb", {"position": 6e-4}, {"position": 5e-4}, 0.05),
    ),
    ceilings=LearnedGains(
        (LearnedGain("cart", "velocity", 0.5, 1e-9, "N", "m/s"),),
        (LearnedGain("cart", "velocity", -0.02, 0.9, "N", "m/s"),),
    ),
    remains=(),
    times=1.4,
    times_fitted=1.3,
    refused="",
    completeness=Completeness(
        "12 bumps over velocity at cart",
        -0.02,
        0.9,
        complete=True,
        gain_before=0.5,
        network_before="12 bumps over velocity at cart",
    ),
    stopped="no further effect passes",
    withdrawn="",
    split="fitted on a, judged on b",
    horizon=1.0,
    horizons=(10, 12),
    rules=Rules(),
    records=(
        UsedRecord("a", "fitted", "simulated", "rig", "0" * 64, 100, 0.01),
        UsedRecord("b", "held out", "simulated", "rig", "1" * 64, 100, 0.01),
    ),
    steps=(
        StepTaken(
            Level("before step 1", {"position": 1.2e-3}, {"position": 1e-3}, 0.1),
            "cart.coulomb",
            (),
            (_tried("stribeck", 0.6), _tried("coulomb", 0.5, "passed")),
        ),
    ),
)


@pytest.fixture
def stored() -> Callable[..., TraceFile]:
    """``stored(verdict="unexplained", accepted=())``: the trace with some of its fields changed."""

    def make(**changes: Any) -> TraceFile:
        found = replace(FOUND, **changes)
        return TraceFile("cart", 2, found.fitted_records, ("hybridid run case=cart",), found)

    return make
