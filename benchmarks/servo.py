"""How well does the servo's model predict a kind of trajectory that it was not fitted to? Measured.

Each form of friction is fitted in free run to the twelve recordings of the case ``servo``, and to two of the
three kinds of trajectory at a time; then it runs freely through the kind that was left out. The measure is
the publishers': the mean absolute error of the angle, mean over recordings. The runs start from the first
samples and see the goal, the gain, the supply and whether the torque is on, nothing else.

The form is chosen without the kind left out: each form is fitted to one of the two other kinds and judged on
the other, and the one with the smallest error, both ways together, is taken.

    python benchmarks/servo.py [--only M1 load ...] [--not-chosen]
"""

from __future__ import annotations

import argparse
import csv
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import studies
from hybridid.estimators import Estimate, fit
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.signals.steps import apply_steps
from hybridid.simulation.simulate import Diverged
from hybridid.simulation.stability import TooStiff
from hybridid.validation.predict import free_run
from hybridid_cli.composing import settings_of
from pipelines.shared.config import Settings
from pipelines.shared.modelling import fit_settings, model_of
from pipelines.shared.sources import sources_of

KINDS = ("up_and_down", "sin_sin", "lift_and_drop")
BASE = ("viscous", "coulomb")
FORMS: Mapping[str, tuple[str, ...]] = {
    "M1 as published": ("R_s=0", *BASE),
    "M1": BASE,
    "load": (*BASE, "load_friction"),
    "load, Stribeck": (*BASE, "load_friction", "load_stribeck"),
    "two-sided": (*BASE, "two_sided_load_friction"),
    "two-sided, Stribeck": (*BASE, "two_sided_load_friction", "load_stribeck"),
}
"""Effects at the joint; ``R_s=0`` fixes that parameter: a torque in proportion to the duty."""
HERE = Path(__file__).resolve().parent
Records = Mapping[str, Record]
Fitted = tuple[Model, Estimate]
Say = Callable[[str], None]


@cache
def configured(form: str) -> Settings:
    """The case's own config with the form's effects."""
    fixed = [f"+parameters.{entry.replace('=', '.fixed=')}" for entry in FORMS[form] if "=" in entry]
    effects = ",".join(entry for entry in FORMS[form] if "=" not in entry)
    return settings_of(["case=servo", f"effects=[{effects}]", *fixed])


def records_of() -> dict[str, Record]:
    """The case's records by name: measured where they are found, else simulated."""
    settings = configured("M1")
    return {
        source.name: apply_steps(source.record(), settings["preprocess.steps"])
        for source in sources_of(settings).found
    }


def of_kind(records: Records, *kinds: str) -> dict[str, Record]:
    """The records of these kinds of trajectory."""
    return {name: record for name, record in records.items() if name.startswith(kinds)}


def fitted(form: str, records: Records) -> Fitted | None:
    """The form, fitted in free run to ``records`` by RK4; None where it is too stiff for that."""
    settings = configured(form)
    model = model_of(settings)
    try:
        return model, fit(model, list(records.values()), replace(fit_settings(settings), integrator="rk4"))
    except TooStiff:
        return None


def error_of(form: Fitted | None, records: Records) -> float:
    """Mean over ``records`` of the mean absolute error [mrad] in free run; infinite for a form that was not
    fitted, and where a run diverges."""
    if form is None:
        return float("inf")
    model, estimate = form
    found = []
    for record in records.values():
        try:
            run = free_run(
                model, estimate.values, record, "measured", estimate.settings.integrator, estimate.substeps
            )
        except Diverged:
            return float("inf")
        found.append(1e3 * float(np.abs(run.error).mean()))
    return float(np.mean(found))


def across(form: str, given: Records, judged: Records) -> float:
    """The error [mrad] on ``judged`` of the form fitted to ``given``."""
    return error_of(fitted(form, given), judged)


def chosen(left: str, records: Records, forms: Sequence[str], say: Say) -> str:
    """The form that predicts best from one to the other of the two kinds beside ``left``."""
    first, second = (of_kind(records, kind) for kind in KINDS if kind != left)
    errors = {form: 0.5 * (across(form, first, second) + across(form, second, first)) for form in forms}
    say(f"without {left}: " + ", ".join(f"{form} {error:.1f}" for form, error in errors.items()))
    return min(errors, key=errors.__getitem__)


def row_of(name: str, whole: float | None, left: Mapping[str, float]) -> list[str]:
    """One row of the table: all twelve, each kind left out, the mean of these."""
    parts = [name, "" if whole is None else f"{whole:.1f}", *(f"{left[kind]:.1f}" for kind in KINDS)]
    return [*parts, f"{np.mean([left[kind] for kind in KINDS]):.1f}"]


def rivals() -> list[list[str]]:
    """The rows of the rivals, from the file beside this one."""
    with (HERE / "servo_rivals.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return [
        row_of(f"rival {row['model']}", float(row["all"]), {kind: float(row[kind]) for kind in KINDS})
        for row in rows
    ]


def main(arguments: Sequence[str] | None = None, say: Say = print) -> dict[str, Any]:
    """Run the study from the command line's ``arguments`` and write it to ``outputs/studies``."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=list(FORMS), default=list(FORMS), help="forms to fit")
    parser.add_argument("--not-chosen", action="store_true", help="leave out the choice among the forms")
    given = parser.parse_args(arguments)
    records = records_of()
    provenance = " and ".join(sorted({record.provenance for record in records.values()}))
    table, result = [], {}
    for form in given.only:
        together = fitted(form, records)
        whole = error_of(together, records)
        say(f"{form} ({provenance}): {outcome_of(together)}")
        apart = {k: fitted(form, without(records, k)) for k in KINDS}
        left = {k: error_of(apart[k], of_kind(records, k)) for k in KINDS}
        unfinished = [k for k, f in {"all": together, **apart}.items() if f is None or not f[1].converged]
        result[form] = {"all": whole, **left, "not_converged": unfinished}
        remark = f" (not converged: {', '.join(unfinished)})" if unfinished else ""
        table.append(row_of(form + remark, whole, left))
        say(" | ".join(table[-1]))
    if not given.not_chosen:
        taken = {kind: chosen(kind, records, given.only, say) for kind in KINDS}
        left = {kind: result[form][kind] for kind, form in taken.items()}
        table.append(row_of(f"chosen without the kind left out: {', '.join(taken.values())}", None, left))
    head = ["form", "all twelve", *(f"without {kind}" for kind in KINDS), "mean"]
    lines = studies.table(head, [*table, *rivals()])
    text = "\n".join([f"Mean absolute error [mrad] in free run ({provenance}).", "", *lines])
    say(text)
    studies.write(studies.OUT / "servo.md", text)
    data = {"provenance": provenance, "forms": result}
    studies.write(studies.OUT / "servo.json", json.dumps(data, indent=1))
    return result


def without(records: Records, kind: str) -> dict[str, Record]:
    """The records of the other kinds."""
    return of_kind(records, *(other for other in KINDS if other != kind))


def outcome_of(form: Fitted | None) -> str:
    """How a fit ended, and the estimated parameters with their units."""
    if form is None:
        return "too stiff to fit"
    _, estimate = form
    return ", ".join([estimate.status, *(f"{p.name} {p.value:.4g} {p.unit}" for p in estimate.parameters)])


if __name__ == "__main__":
    main()
