"""The report of a trace, from the data of ``trace.json`` and its figures: one page for HTML and Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

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
from pipelines.shared.page import Page, Picture, Section, Table
from pipelines.trace.proof import AFTER, BEFORE
from pipelines.trace.words import VERDICTS, estimates, outcome, sentence

Data = Mapping[str, Any]


def trace_page(data: Data, pictures: Sequence[Picture]) -> Page:
    """Verdict, proof, evidence, what was refused and why, what is left, how it was decided."""
    about = {
        kind: _of(pictures, kind) for kind in ("waterfall", "trials", "missing_effort", "ceiling", "error")
    }
    sections = (
        Section("Before and after", tables=_scores(data), pictures=about["waterfall"]),
        _accepted(data),
        Section("Parameters", tables=(_parameters(data),)),
        Section("What was tried", (_TRIED,), _refused(data), about["trials"]),
        Section("The residual", (_RESIDUAL,), pictures=(*about["error"], *about["missing_effort"])),
        _remaining(data, about["ceiling"]),
        Section("How it was decided", tables=(_rules(data),)),
        _use(data),
    )
    marks = (VERDICTS[data["verdict"]], data["provenance"], f"case {data['case']}")
    return Page(
        f"Trace of {data['case']}", sentence(data), tuple(s for s in sections if s is not None), marks
    )


_TRIED = (
    "Every effect at every port of its kind was added to the model and all parameters refitted together; the "
    "gain is the relative decrease of the RMSE on horizons that no fit has seen. p-values are adjusted for "
    "all effects tried in a step (Holm)."
)
_RESIDUAL = (
    "The missing effort is what would have to act at the port, beyond the model, for the model to agree with "
    "the record: estimated by a smoother, never by differentiating noise twice."
)


def _of(pictures: Sequence[Picture], kind: str) -> tuple[Picture, ...]:
    return tuple(p for p in pictures if kind in p.path.stem.split("."))


def _scores(data: Data) -> tuple[Table, ...]:
    """A table an output; in it a row a model, those of one record and view together."""
    rows = [*data["before"], *(data["after"] if data["accepted"] else ())]
    models = [[r for r in rows if r["model"] == name] for name in dict.fromkeys(r["model"] for r in rows)]
    groups = list(zip(*models, strict=True))
    header = ("record", "", "view", "model", "RMSE", "change", "MSE", "R²", "data")
    notes = (
        f"Effects declared: {listed(data['declared'] or ['none'])}; added: "
        f"{listed([_name(a) for a in data['accepted']] or ['none'])}. "
        f"Each with every parameter refitted over horizons of {data['horizon']:g} s of "
        f"{listed(data['fitted_records'])}.",
        *(("The network has seen only the fitted horizons.",) if data["completeness"] else ()),
    )
    tables = []
    for output in data["noise_floor"]:
        rows = [_score(row, same[0]) for same in groups for row in same if row["output"] == output]
        tables.append(
            Table(f"Error of {output} before and after", header, tuple(rows), words=(0, 1, 2, 3, 8))
        )
    return (*tables[:-1], replace(tables[-1], notes=notes))


def _score(row: Data, first: Data) -> tuple[str, ...]:
    leading = row is first
    where = (row["record"], row["role"], _view(row)) if leading else ("", "", "")
    changed = "" if leading else change(first["rmse"], row["rmse"])
    return (
        *where,
        row["model"],
        quantity(row["rmse"], row["unit"]),
        changed,
        mean_square(row["mse"], row["unit"]),
        r_squared(row["r2"]),
        row["provenance"],
    )


def _name(entry: Data) -> str:
    return f"{entry['port']}.{entry['effect']}"


def _accepted(data: Data) -> Section | None:
    if not data["accepted"]:
        return None
    header = ("effect", "port", "estimate ± 95 %", "gain", "p", "cannot be told from", "step")
    rows = tuple(
        (
            a["effect"], a["port"], "; ".join(estimates(a["parameters"])),
            share(a["gain"]), probability(a["p_value"]),
            ", ".join(i for i in a["class"] if i != a["effect"]) or NONE, str(a["step"]),
        )
        for a in data["accepted"]
    )  # fmt: skip
    effects = Table(f"Accepted ({data['provenance']})", header, rows, words=(0, 1, 2, 5))
    paragraphs = [
        f"{a['effect']}: {a['title']}, {a['equation']}. {_capital(a['pattern'])}." for a in data["accepted"]
    ]
    paragraphs += [
        f"To tell {listed(a['class'])} apart, record: {'; or '.join(a['separating_experiments'])}."
        for a in data["accepted"]
        if a["separating_experiments"]
    ]
    return Section("What was accepted", tuple(paragraphs), (effects, *map(_survival, data["accepted"])))


def _survival(entry: Data) -> Table:
    names = list(entry["parameters"])
    declared = (share(entry["gain"]), "", probability(entry["p_value"]))
    rows = [("as declared", *declared, *_values(entry["at_step"], names), "")]
    rows += [
        (
            s["variation"], share(s["gain"]), percent(s["kept"], 0), probability(s["p_value"]),
            *_values(s["parameters"], names), _outcome(s),
        )
        for s in entry["survivals"]
    ]  # fmt: skip
    units = [f"{n} [{entry['parameters'][n]['unit']}]" for n in names]
    notes = [
        "Kept: of what the effect takes from the squared error as declared. A gain or a parameter that went "
        "away with these would belong to the numerics, not to the machine."
    ]
    if any(s["refuted"] for s in entry["survivals"]):
        notes.append(
            "Refuted: solved so, even the augmented model errs far more: this is no other explanation."
        )
    title = f"{entry['effect']} at {entry['port']} when the equations are solved another way"
    header = ("variation", "gain", "kept", "p", *units, "")
    return Table(title, header, tuple(rows), tuple(notes), words=(0, len(header) - 1))


def _outcome(survival: Data) -> str:
    if not survival["simulated"]:
        return "too stiff to be tried" if survival["survives"] else DIVERGES
    if survival["refuted"]:
        return "refuted by the records"
    return "survives" if survival["survives"] else "lost"


def _values(parameters: Mapping[str, float], names: Sequence[str]) -> tuple[str, ...]:
    return tuple(number(parameters.get(n), missing="") for n in names)


def _parameters(data: Data) -> Table:
    before, after = data["estimates"]["before"], data["estimates"]["after"]
    rows = []
    for name in dict.fromkeys((*before, *after)):
        unit = (before.get(name) or after.get(name))["unit"]
        cells = [_interval(table.get(name)) for table in (before, after)]
        rows.append((name, *(text for cell in cells for text in cell), unit))
    header = ("parameter", BEFORE, "95 % interval", AFTER, "95 % interval", "unit")
    notes = (
        "Intervals allow for autocorrelated residuals; they say nothing of physics that is still missing.",
    )
    title = f"Estimates from {listed(data['fitted_records'])} ({data['provenance']})"
    return Table(title, header, tuple(rows), notes, words=(0, 5))


def _interval(parameter: Data | None) -> tuple[str, str]:
    if parameter is None:
        return NONE, ""
    low, high = parameter["interval_95"]
    interval = UNKNOWN if low is None or high is None else f"{number(low, 5)} to {number(high, 5)}"
    flags = (
        " (at bound)" if parameter["at_bound"] else "" if parameter["identifiable"] else " (not identifiable)"
    )
    return number(parameter["value"], 5), interval + flags


def _refused(data: Data) -> tuple[Table, ...]:
    header = ("effect", "port", "gain", "p", "decision", "reason")
    rows = tuple(
        (r["effect"], r["port"], share(r["gain"]), probability(r["p_value"]), r["status"], r["reason"])
        for r in data["rejected"]
    )
    title = f"Tried and not accepted: {len(rows)}, as last judged ({data['provenance']})"
    return (Table(title, header, rows, words=(0, 1, 4, 5)),) if rows else ()


def _remaining(data: Data, pictures: tuple[Picture, ...]) -> Section:
    header = ("port", "over", BEFORE, AFTER, "p of the latter")
    before = {(c["port"], c["over"]): c for c in data["ceilings"]["before"]}
    rows = tuple(
        (
            c["port"],
            c["over"],
            _up_to(before[c["port"], c["over"]]["gain"]),
            _up_to(c["gain"]),
            probability(c["p_value"]),
        )
        for c in data["ceilings"]["after"]
    )
    tables = (
        [Table("Error that a learned effort would take away", header, rows, words=(0, 1))] if rows else []
    )
    errors = [
        f"{quantity(data['path'][-1]['held_out_rmse'][name], floor['unit'], 3)} of {name} "
        f"(noise floor of its sensor: {quantity(floor['value'], floor['unit'], 3)})"
        for name, floor in data["noise_floor"].items()
    ]
    said = (f"RMSE on held-out horizons: {listed(errors)}.", _structure(data), *_completeness(data))
    return Section("What is left", said, tuple(tables), pictures)


def _structure(data: Data) -> str:
    """What learned efforts say of the error that is left."""
    rules, worth, after = data["rules"], percent(data["rules"]["worth"]), data["ceilings"]["after"]
    if data["remains"]:
        return (
            f"Structure remains {listed(data['remains'])}: a learned effort there still lowers the held-out "
            f"error by {worth} or more, and no effect in the library does."
        )
    if any(c["gain"] >= rules["worth"] and c["p_value"] <= rules["alpha"] for c in after):
        return (
            f"A learned effort still lowers the held-out error by {worth} or more, but the strongest do not "
            "keep that gain when the equations are solved another way (epsilon, step, integrator, input "
            "hold): no evidence that the machine lacks something."
        )
    return f"No learned effort takes {worth} or more from the held-out error."


def _completeness(data: Data) -> tuple[str, ...]:
    check = data["completeness"]
    if check is None:
        return ()
    last = AFTER if data["accepted"] else BEFORE
    return (
        f"Completeness check: a network ({check['network']}) takes {_up_to(check['gain'])} from the held-out "
        f"error of the {last} (p {probability(check['p_value'], '= ')}): {outcome(data)}.",
    )


def _rules(data: Data) -> Table:
    rules = data["rules"]
    rows = (
        ("horizons", f"{data['split']}; {data['horizon']:g} s each, {data['horizons'][0]} fitted, "
                     f"{data['horizons'][1]} held out"),
        ("records", listed([f"{r['name']} ({r['provenance']}, {r['source']})" for r in data["records"]])),
        ("significant", f"adjusted p at most {rules['alpha']:g} over all effects tried in a step"),
        ("worth having", f"held-out RMSE lower by {percent(rules['worth'])} or more"),
        ("alike", f"effects whose errors differ by less than {percent(rules['tie'])}, or not significantly"),
        ("identifiable", f"standard errors at most {percent(rules['vague'])} of the value, correlations at "
                         f"most {rules['collinear']:g}"),
        ("name trusted", "a learned effort beside it takes at most "
                         f"{percent(rules['stands_in'])} of what both take from the squared error"),
        ("search ended", data["stopped"]),
        ("took", f"{data['seconds']:.0f} s on {data['processes']} processes"),
    )  # fmt: skip
    return Table("Rules", ("", ""), rows, words=(0, 1))


def _use(data: Data) -> Section | None:
    if not data["accepted"]:
        return None
    text = "The augmented model is a model like any other: fit, validate and plot take it up."
    return Section("How to go on", (text,), commands=tuple(data["commands"]))


def _view(row: Data) -> str:
    return f"{row['horizon']:g} s horizons" if row["view"] == "horizon" else "free run"


def _up_to(gain: float) -> str:
    """What a learned effort could take away; one that only learned noise takes nothing."""
    return share(max(gain, 0.0))


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
