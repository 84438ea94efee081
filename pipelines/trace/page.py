"""The report of a trace as a page: verdict, proof, evidence, what was refused and why, what is left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from hybridid.naming import listed
from hybridid.quantities import (
    DIVERGES,
    NONE,
    UNKNOWN,
    change,
    mean_square,
    number,
    percent,
    probability,
    quantity,
    r_squared,
    share,
)
from hybridid.trace.before_after import AFTER, BEFORE, ScoreRow
from hybridid.trace.entries import AcceptedEffect, EstimatedValue, LearnedGain
from hybridid.trace.result import Trace
from hybridid.trace.robustness import Survival
from hybridid.trace.words import (
    VERDICTS,
    completeness_in_words,
    parameters_in_words,
    structure_in_words,
)
from pipelines.shared.page import Page, Picture, Section, Table
from pipelines.shared.traced import TraceFile

KINDS = ("waterfall", "trials", "missing_effort", "ceiling", "error")
"""Of the figures, as their files' names say."""
_TRIED = (
    "Every effect at every port of its kind was added to the model and all parameters refitted together; the "
    "gain is the relative decrease of the RMSE on horizons that no fit has seen. p-values are adjusted for "
    "all effects tried in a step (Holm)."
)
_RESIDUAL = (
    "The missing effort is what would have to act at the port, beyond the model, for the model to agree with "
    "the record: estimated by a smoother, never by differentiating noise twice."
)


def trace_page(said: TraceFile, pictures: Sequence[Picture]) -> Page:
    """The page of a stored trace with its figures, each named ``<...>.<kind>``."""
    found = said.found
    about = {kind: tuple(p for p in pictures if kind in p.path.stem.split(".")) for kind in KINDS}
    sections = (
        Section("Before and after", tables=_scores(found), pictures=about["waterfall"]),
        _accepted(found),
        Section("Parameters", tables=(_parameters(found),)),
        Section("What was tried", (_TRIED,), _refused(found), about["trials"]),
        Section("The residual", (_RESIDUAL,), pictures=(*about["error"], *about["missing_effort"])),
        _remaining(found, about["ceiling"]),
        Section("How it was decided", tables=(_rules(said),)),
        _use(said),
    )
    marks = (VERDICTS[found.verdict], found.provenance, f"case {said.case}")
    shown = tuple(section for section in sections if section is not None)
    return Page(f"Trace of {said.case}", found.sentence, shown, marks)


def _scores(found: Trace) -> tuple[Table, ...]:
    """A table an output; in it a row a model, those of one record and view together."""
    rows = [*found.before, *(found.after if found.accepted else ())]
    models = [[r for r in rows if r.model == name] for name in dict.fromkeys(r.model for r in rows)]
    groups = list(zip(*models, strict=True))
    header = ("record", "", "view", "model", "RMSE", "change", "MSE", "R²", "data")
    notes = (
        f"Effects declared: {listed(found.declared or ['none'])}; added: "
        f"{listed([entry.name for entry in found.accepted] or ['none'])}. "
        f"Each with every parameter refitted over horizons of {found.horizon:g} s of "
        f"{listed(found.fitted_records)}.",
        *(("The network has seen only the fitted horizons.",) if found.completeness else ()),
    )
    tables = []
    for output in found.noise_floor:
        cells = [_score(row, same[0]) for same in groups for row in same if row.output == output]
        tables.append(
            Table(f"Error of {output} before and after", header, tuple(cells), words=(0, 1, 2, 3, 8))
        )
    return (*tables[:-1], replace(tables[-1], notes=notes))


def _score(row: ScoreRow, first: ScoreRow) -> tuple[str, ...]:
    leading = row is first
    where = (row.record, row.role, _view(row)) if leading else ("", "", "")
    return (
        *where,
        row.model,
        quantity(row.rmse, row.unit),
        "" if leading else change(first.rmse, row.rmse),
        mean_square(row.mse, row.unit),
        r_squared(row.r2),
        row.provenance,
    )


def _view(row: ScoreRow) -> str:
    return "free run" if row.horizon is None else f"{row.horizon:g} s horizons"


def _accepted(found: Trace) -> Section | None:
    if not found.accepted:
        return None
    header = ("effect", "port", "estimate ± 95 %", "gain", "p", "cannot be told from", "step")
    rows = tuple(
        (
            a.effect, a.port, "; ".join(parameters_in_words(a)), share(a.gain), probability(a.p_value),
            ", ".join(a.others) or NONE, str(a.step),
        )
        for a in found.accepted
    )  # fmt: skip
    effects = Table(f"Accepted ({found.provenance})", header, rows, words=(0, 1, 2, 5))
    paragraphs = [f"{a.effect}: {a.title}, {a.equation}. {_capital(a.pattern)}." for a in found.accepted]
    paragraphs += [
        f"To tell {listed(a.alike)} apart, record: {'; or '.join(a.separating_experiments)}."
        for a in found.accepted
        if a.separating_experiments
    ]
    return Section("What was accepted", tuple(paragraphs), (effects, *map(_survivals, found.accepted)))


def _survivals(entry: AcceptedEffect) -> Table:
    names = list(entry.parameters)
    declared = (share(entry.gain), "", probability(entry.p_value))
    rows = [("as declared", *declared, *_values(entry.at_step, names), "")]
    rows += [
        (
            s.variation, share(s.gain), percent(s.kept, 0), probability(s.p_value),
            *_values(s.parameters, names), _outcome(s),
        )
        for s in entry.survivals
    ]  # fmt: skip
    notes = [
        "Kept: of what the effect takes from the squared error as declared. A gain or a parameter that went "
        "away with these would belong to the numerics, not to the machine."
    ]
    if any(s.refuted for s in entry.survivals):
        notes.append(
            "Refuted: solved so, even the augmented model errs far more: this is no other explanation."
        )
    units = [f"{name} [{entry.parameters[name].unit}]" for name in names]
    header = ("variation", "gain", "kept", "p", *units, "")
    title = f"{entry.effect} at {entry.port} when the equations are solved another way"
    return Table(title, header, tuple(rows), tuple(notes), words=(0, len(header) - 1))


def _outcome(survival: Survival) -> str:
    if not survival.simulated:
        return "too stiff to be tried" if survival.survives else DIVERGES
    if survival.refuted:
        return "refuted by the records"
    return "survives" if survival.survives else "lost"


def _values(parameters: Mapping[str, float], names: Sequence[str]) -> tuple[str, ...]:
    return tuple(number(parameters.get(name), missing="") for name in names)


def _parameters(found: Trace) -> Table:
    before, after = found.estimates.before, found.estimates.after
    rows = []
    for name in dict.fromkeys((*before, *after)):
        either = before.get(name) or after[name]
        cells = [_interval(estimates.get(name)) for estimates in (before, after)]
        rows.append((name, *(text for cell in cells for text in cell), either.unit))
    header = ("parameter", BEFORE, "95 % interval", AFTER, "95 % interval", "unit")
    notes = (
        "Intervals allow for autocorrelated residuals; they say nothing of physics that is still missing.",
    )
    title = f"Estimates from {listed(found.fitted_records)} ({found.provenance})"
    return Table(title, header, tuple(rows), notes, words=(0, 5))


def _interval(parameter: EstimatedValue | None) -> tuple[str, str]:
    if parameter is None:
        return NONE, ""
    low, high = (number(end, 5) for end in parameter.interval_95)
    interval = UNKNOWN if UNKNOWN in (low, high) else f"{low} to {high}"
    flags = " (at bound)" if parameter.at_bound else "" if parameter.identifiable else " (not identifiable)"
    return number(parameter.value, 5), interval + flags


def _refused(found: Trace) -> tuple[Table, ...]:
    header = ("effect", "port", "gain", "p", "decision", "reason")
    rows = tuple(
        (r.effect, r.port, share(r.gain), probability(r.p_value), r.status, r.reason) for r in found.rejected
    )
    title = f"Tried and not accepted: {len(rows)}, as last judged ({found.provenance})"
    return (Table(title, header, rows, words=(0, 1, 4, 5)),) if rows else ()


def _remaining(found: Trace, pictures: tuple[Picture, ...]) -> Section:
    header = ("port", "over", BEFORE, AFTER, "p of the latter")
    before = {(c.port, c.over): c for c in found.ceilings.before}
    rows = tuple(
        (c.port, c.over, _taken(before[c.port, c.over]), _taken(c), probability(c.p_value))
        for c in found.ceilings.after
    )
    tables = (
        [Table("Error that a learned effort would take away", header, rows, words=(0, 1))] if rows else []
    )
    errors = [
        f"{quantity(found.path[-1].held_out_rmse[name], floor.unit, 3)} of {name} "
        f"(noise floor of its sensor: {quantity(floor.value, floor.unit, 3)})"
        for name, floor in found.noise_floor.items()
    ]
    paragraphs = [f"RMSE on held-out horizons: {listed(errors)}.", structure_in_words(found)]
    if found.completeness:
        paragraphs.append(f"Completeness check: {completeness_in_words(found)}.")
    return Section("What is left", tuple(paragraphs), tuple(tables), pictures)


def _taken(learned: LearnedGain) -> str:
    """What a learned effort could take away; one that only learned noise takes nothing."""
    return share(max(learned.gain, 0.0))


def _rules(said: TraceFile) -> Table:
    found = said.found
    rules, (fitted, held_out) = found.rules, found.horizons
    rows = (
        ("horizons", f"{found.split}; {found.horizon:g} s each, {fitted} fitted, {held_out} held out"),
        ("records", listed([f"{r.name} ({r.provenance}, {r.source})" for r in found.records])),
        ("significant", f"adjusted p at most {rules.alpha:g} over all effects tried in a step"),
        ("worth having", f"held-out RMSE lower by {percent(rules.worth)} or more"),
        ("alike", f"effects whose errors differ by less than {percent(rules.tie)}, or not significantly"),
        ("identifiable", f"standard errors at most {percent(rules.vague)} of the value, correlations at "
                         f"most {rules.collinear:g}"),
        ("name trusted", "a learned effort beside it takes at most "
                         f"{percent(rules.stands_in)} of what both take from the squared error"),
        ("search ended", found.stopped),
        ("took", f"{found.seconds:.0f} s on {said.processes} processes"),
    )  # fmt: skip
    return Table("Rules", ("", ""), rows, words=(0, 1))


def _use(said: TraceFile) -> Section | None:
    if not said.found.accepted:
        return None
    text = "The augmented model is a model like any other: fit, validate and plot take it up."
    return Section("How to go on", (text,), commands=said.commands)


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
