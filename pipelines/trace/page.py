"""The report of a trace as a page: verdict, scores, accepted effects, rejected effects, remaining error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from hybridid.naming import as_entry, listed
from hybridid.quantities import (
    DIVERGES,
    NONE,
    UNKNOWN,
    digits_apart,
    estimated,
    number,
    percent,
    probability,
    share,
)
from hybridid.trace.entries import AcceptedEffect, EstimatedValue, LearnedGain
from hybridid.trace.results.before_after import AFTER, BEFORE
from hybridid.trace.results.result import Trace
from hybridid.trace.trials.robustness import Survival
from hybridid.trace.words.remarks import (
    completeness_in_words,
    equation_in_words,
    finer_in_words,
    idle_in_words,
    learned,
    narrowed_in_words,
    parameters_in_words,
    rivals,
    structure_in_words,
    unsure_in_words,
)
from hybridid.trace.words.replacement_words import gained
from hybridid.trace.words.words import VERDICTS, error_left
from pipelines.shared.page import Page, Picture, Section, Table
from pipelines.shared.traced import TraceFile
from pipelines.trace.rules_table import rules_table
from pipelines.trace.scores import score_tables

KINDS = ("waterfall", "trials", "missing_effort", "ceiling", "error", "law")
"""Kinds of figures, as in the names of their files."""
MOST_LAWS = 10
"""Refused laws that are told."""
_TRIED = (
    "Every effect at every port of its kind was added to the model and all parameters refitted together; the "
    "gain is the relative decrease of the RMSE on horizons that no fit has seen. p-values are adjusted for "
    "all effects tried in a step (Holm, weighted by what each takes from the fitted horizons)."
)
_PAIRS = (
    "Where no effect passed, pairs of effects were ranked by what each takes beside the other in a "
    "least-squares fit of the residual, and the most promising ones refitted. Their p-values are adjusted "
    "for all pairs that could be formed."
)
_BY_HELD_OUT = (
    "The model was also fitted to the held-out records alone. A law of physics keeps its amplitude there. "
    "One that only resembles what is missing is bent to each record anew."
)
_RESIDUAL = (
    "The missing effort (at a level: flow) is what the model would need in addition at the port to agree "
    "with the record. A smoother estimates it: differentiating the record would amplify its noise."
)


def trace_page(traced: TraceFile, pictures: Sequence[Picture]) -> Page:
    """The page of a stored trace with its figures, each named ``<...>.<kind>``."""
    found = traced.found
    about = {kind: tuple(p for p in pictures if kind in p.path.stem.split(".")) for kind in KINDS}
    sections = (
        Section("Before and after", tables=score_tables(found), pictures=about["waterfall"]),
        _accepted(found, about["law"]),
        Section("Parameters", tables=(_parameters(found),)),
        _declared(found),
        _by_recording(found),
        Section(
            "What was tried",
            _tried(found),
            (*_refused(found), *_pairs(found), *_laws(found)),
            about["trials"],
        ),
        Section("The residual", (_RESIDUAL,), pictures=(*about["error"], *about["missing_effort"])),
        _remaining(found, about["ceiling"]),
        Section("How it was decided", tables=(rules_table(traced),)),
        _use(traced),
    )
    marks = (VERDICTS[found.verdict], found.provenance, f"case {traced.case}")
    shown = tuple(section for section in sections if section is not None)
    return Page(f"Trace of {traced.case}", found.sentence, shown, marks, found.cautions)


def _accepted(found: Trace, pictures: tuple[Picture, ...]) -> Section | None:
    if not found.accepted:
        return None
    header = (
        "effect", "port", "estimate ± 95 %", "refitted to the held-out records", "gain", "adjusted p",
        "cannot be told from", "step",
    )  # fmt: skip
    rows = tuple(
        (
            a.effect, a.port, "; ".join(parameters_in_words(a.parameters)),
            "; ".join(parameters_in_words(a.by_held_out)) or NONE, share(a.gain), probability(a.p_value),
            ", ".join(a.others) or NONE, str(a.step),
        )
        for a in found.accepted
    )  # fmt: skip
    notes = tuple(note for note in (_BY_HELD_OUT, unsure_in_words(found)) if note)
    effects = Table(f"Accepted ({found.provenance})", header, rows, notes, words=(0, 1, 2, 3, 6))
    paragraphs = [
        f"{a.effect}: {a.title}, {equation_in_words(a)}. {a.pattern[:1].upper()}{a.pattern[1:]}."
        for a in found.accepted
    ]
    paragraphs += rivals(found)
    paragraphs += [
        f"{a.name} was found only together with {a.together}; its gain is the one beside it."
        for a in found.accepted
        if a.together
    ]
    paragraphs += [
        f"To tell {listed((a.effect, *a.others))} apart, record: {'; or '.join(a.separating_experiments)}."
        for a in found.accepted
        if a.separating_experiments
    ]
    tables = (effects, *map(_survivals, found.accepted))
    return Section("What was accepted", tuple(paragraphs), tables, pictures)


def _declared(found: Trace) -> Section | None:
    """What speaks against the declared physics."""
    remarks = (idle_in_words(found), narrowed_in_words(found), finer_in_words(found))
    said = tuple(one for one in remarks if one)
    if not (said or found.replacements):
        return None
    header = ("left out", "in its place", "what it gains", "p", "effects=[...] of the revised model")
    rows = tuple(
        (
            r.left_out, listed(r.effects), gained(r), probability(r.p_value),
            ", ".join((*(as_entry(name) for name in found.declared if name != r.left_out), *r.names)),
        )
        for r in found.replacements
    )  # fmt: skip
    note = (
        "Each declared effect was left out in turn, and the search begun anew. p is that of no less error, "
        "and counts all that was tried; where a replacement is as good, p is that of no more error."
    )
    title = f"Declared effects that others replace ({found.provenance})"
    tables = (Table(title, header, rows, (note,), words=(0, 1, 4)),) if rows else ()
    return Section("The declared physics", said, tables)


def _by_recording(found: Trace) -> Section | None:
    """Which parameters were tried with a value for each record."""
    if not found.by_recording:
        return None
    header = (
        "parameter",
        "value ± 95 %",
        "gain",
        "adjusted p",
        "in place of",
        "cannot be told from",
        "decision",
        "reason",
    )
    rows = tuple(
        (
            one.parameter,
            "; ".join(f"{record}: {estimated(v.value, v.std, v.unit)}" for record, v in one.values.items()),
            share(one.gain),
            probability(one.p_value),
            one.in_place_of or NONE,
            ", ".join(one.alike) or NONE,
            one.status,
            one.reason,
        )
        for one in found.by_recording
    )
    title = f"Parameters of the last model with a value for each record ({found.provenance})"
    return Section(
        "What differs by recording", tables=(Table(title, header, rows, words=(0, 1, 4, 5, 6, 7)),)
    )


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
        "Kept: the reduction of the squared error, relative to that as declared. If the gain or a parameter "
        "vanished here, it would come from the numerical method, not from the machine."
    ]
    if any(s.refuted for s in entry.survivals):
        notes.append(
            "Refuted: solved this way, even the augmented model has a far larger error. So the variation is "
            "not another explanation of the effect."
        )
    units = [f"{name} [{entry.parameters[name].unit}]" for name in names]
    header = ("variation", "gain", "kept", "p", *units, "")
    title = f"{entry.effect} at {entry.port} with other numerical settings, in step {entry.step}"
    return Table(title, header, tuple(rows), tuple(notes), words=(0, len(header) - 1))


def _outcome(survival: Survival) -> str:
    if not survival.simulated:
        return "too stiff to simulate" if survival.survives else DIVERGES
    if survival.refuted:
        return "refuted by the records"
    return "survives" if survival.survives else "lost"


def _values(parameters: Mapping[str, float], names: Sequence[str]) -> tuple[str, ...]:
    return tuple(number(parameters.get(name), missing="") for name in names)


def _parameters(found: Trace) -> Table:
    """Those of the declared model and, if something was added to it, of the last one."""
    models = {BEFORE: found.estimates.before}
    if found.accepted:
        models[AFTER] = found.estimates.after
    rows = []
    for name in dict.fromkeys(name for of in models.values() for name in of):
        unit = next(of[name].unit for of in models.values() if name in of)
        cells = [_interval(of.get(name)) for of in models.values()]
        rows.append((name, *(text for cell in cells for text in cell), unit))
    columns = tuple(title for model in models for title in (model, "95 % interval"))
    header = ("parameter", *columns, "unit")
    notes = (
        "Intervals allow for autocorrelated residuals. They do not cover errors from physics still missing.",
    )
    title = f"Estimates from {listed(found.fitted_records)} ({found.provenance})"
    return Table(title, header, tuple(rows), notes, words=(0, len(header) - 1))


def _interval(parameter: EstimatedValue | None) -> tuple[str, str]:
    if parameter is None:
        return NONE, ""
    digits = digits_apart(*parameter.interval_95, least=5)
    low, high = (number(end, digits) for end in parameter.interval_95)
    interval = UNKNOWN if UNKNOWN in (low, high) else f"{low} to {high}"
    flags = " (at bound)" if parameter.at_bound else "" if parameter.identifiable else " (not identifiable)"
    return number(parameter.value, digits), interval + flags


def _refused(found: Trace) -> tuple[Table, ...]:
    header = ("effect", "port", "gain", "adjusted p", "decision", "reason")
    rows = tuple(
        (r.effect, r.port, share(r.gain), _p(r.gain, r.p_value), r.status, r.reason) for r in found.rejected
    )
    title = f"Tried and not accepted: {len(rows)}, each as judged last ({found.provenance})"
    return (Table(title, header, rows, words=(0, 1, 4, 5)),) if rows else ()


def _p(gain: float, p_value: float) -> str:
    """The p-value of a gain; none where nothing was gained."""
    return probability(p_value) if gain > 0 else NONE


def _tried(found: Trace) -> tuple[str, ...]:
    if not found.steps:
        return (f"No effect was tried: {found.stopped}.",)
    said = (_TRIED, _PAIRS) if any(step.pairs for step in found.steps) else (_TRIED,)
    left_out = found.steps[-1].left_out
    return (*said, f"The time limit left untried: {listed(left_out)}.") if left_out else said


def _pairs(found: Trace) -> tuple[Table, ...]:
    header = ("effects", "promise", "gain", "of each beside the other", "adjusted p", "decision", "reason")
    rows = tuple(
        (
            listed(pair.effects), share(pair.promised), share(pair.gain),
            ", ".join(map(share, pair.gains)) or NONE, _p(pair.gain, pair.p_value),
            "accepted" if pair.name == " + ".join(step.taken) else pair.status, pair.reason,
        )
        for step in found.steps
        for pair in step.pairs
    )  # fmt: skip
    family = sum(step.family for step in found.steps)
    title = f"Pairs tried: the {len(rows)} most promising of {family} ({found.provenance})"
    return (Table(title, header, rows, words=(0, 5, 6)),) if rows else ()


def _laws(found: Trace) -> tuple[Table, ...]:
    header = ("law", "port", "gain", "adjusted p", "decision", "reason")
    rows = tuple(
        (law.effect, law.port, share(law.gain), _p(law.gain, law.p_value), law.status, law.reason)
        for law in found.refused_laws[:MOST_LAWS]
    )
    title = (
        f"Laws tried beside the last model: the best {len(rows)} of {len(found.refused_laws)}; none passes. "
        f"All {found.laws_formed} that could be formed count ({found.provenance})"
    )
    return (Table(title, header, rows, words=(0, 1, 4, 5)),) if rows else ()


def _remaining(found: Trace, pictures: tuple[Picture, ...]) -> Section:
    first, last = ({(c.port, c.over): c for c in of} for of in (found.ceilings.before, found.ceilings.after))
    models = {BEFORE: first, AFTER: last} if found.accepted else {BEFORE: last}
    header = ("port", "over", *models, f"p {AFTER if found.accepted else BEFORE}")
    rows = tuple(
        (*place, *(_taken(of[place]) for of in models.values()), _p(c.gain, c.p_value))
        for place, c in last.items()
    )
    title = f"Reduction of the error by a {learned(found)}"
    tables = [Table(title, header, rows, words=(0, 1))] if rows else []
    paragraphs = [f"On held-out horizons: {error_left(found)}", structure_in_words(found)]
    if found.completeness:
        paragraphs.append(f"Completeness check: {completeness_in_words(found)}.")
    return Section("What is left", tuple(paragraphs), tuple(tables), pictures)


def _taken(one: LearnedGain) -> str:
    """The reduction of the error by a learned effort; none by one that learned only noise."""
    if one.failure:
        return f"not solved: {one.failure}"
    if not one.fitted:
        return "not fitted"
    taken = share(one.gain) if one.gain > 0 else "none"
    return taken + (" (ended early)" if one.ended_early else "")


def _use(traced: TraceFile) -> Section | None:
    found = traced.found
    apart = "The recordings disagree: the command with by=record gives each its own values."
    onward = (
        "fit, validate and plot work with the last model as with any other model. The command with model= "
        "begins where this trace ended. The last one needs no file of it and begins at the guesses: it may "
        "end elsewhere, so compare its errors with those above."
    )
    goes_on = found.accepted or found.narrowed
    further = "The commands with trace ask what the cautions advise."
    said = {apart: found.own_values, onward: goes_on, further: traced.further_traces}
    told = tuple(words for words, due in said.items() if due)
    given = traced.commands if goes_on else traced.commands[:1] if found.own_values else ()
    commands = (*given, *traced.further_traces)
    return Section("Next commands", told, commands=commands) if told else None
