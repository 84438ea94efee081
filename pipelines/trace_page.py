"""The report of a trace, from the data of ``trace.json`` and its figures: one page for HTML and Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pipelines.page import Page, Picture, Section, Table
from pipelines.trace_words import (
    VERDICTS,
    estimated,
    listed,
    probability,
    quantity,
    sentence,
    share,
)

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
    """Before beside after, a row a record, output and view."""
    after = {_key(row): row for row in data["after"]}
    rows = []
    for row in data["before"]:
        better = after[_key(row)]
        rows.append(
            (
                f"{row['record']} ({row['role']})", row["output"], _view(row),
                quantity(row["rmse"], row["unit"]), quantity(better["rmse"], row["unit"]),
                _change(row["rmse"], better["rmse"]),
                _r2(row), _r2(better), _mse(row), _mse(better), row["provenance"],
            )
        )  # fmt: skip
    header = (
        "record", "output", "view", "RMSE before", "after", "change",
        "R² before", "after", "MSE before", "after", "data",
    )  # fmt: skip
    notes = (
        f"Before: {listed(data['declared'])}. After: {listed(data['effects'])}. Each with every parameter "
        f"refitted over horizons of {data['horizon']:g} s of {listed(data['fitted_records'])}.",
    )
    return (Table("Error before and after", header, tuple(rows), notes, words=(0, 1, 2, 10)),)


def _accepted(data: Data) -> Section | None:
    if not data["accepted"]:
        return None
    header = ("effect", "port", "estimate ± 95 %", "gain", "p", "cannot be told from", "step")
    rows = tuple(
        (
            a["effect"], a["port"], "; ".join(f"{n} = {estimated(p)}" for n, p in a["parameters"].items()),
            share(a["gain"]), probability(a["p_value"]),
            ", ".join(i for i in a["class"] if i != a["effect"]) or "–", str(a["step"]),
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
    rows = [
        (
            "as declared",
            share(entry["gain"]),
            probability(entry["p_value"]),
            *_values(entry["at_step"], names),
        )
    ]
    rows += [
        (s["variation"], share(s["gain"]), probability(s["p_value"]), *_values(s["parameters"], names))
        for s in entry["survivals"]
    ]
    units = [f"{n} [{entry['parameters'][n]['unit']}]" for n in names]
    note = "A gain or a parameter that moves with these would belong to the numerics, not to the machine."
    title = f"{entry['effect']} at {entry['port']} when the equations are solved another way"
    return Table(title, ("variation", "gain", "p", *units), tuple(rows), (note,))


def _values(parameters: Mapping[str, float], names: Sequence[str]) -> tuple[str, ...]:
    return tuple(f"{parameters[n]:.4g}".replace("-", "−") if n in parameters else "" for n in names)


def _parameters(data: Data) -> Table:
    before, after = data["estimates"]["declared"], data["estimates"]["augmented"]
    rows = []
    for name in dict.fromkeys((*before, *after)):
        unit = (before.get(name) or after.get(name))["unit"]
        cells = [_interval(table.get(name)) for table in (before, after)]
        rows.append((name, *(text for cell in cells for text in cell), unit))
    header = ("parameter", "declared", "95 % interval", "augmented", "95 % interval", "unit")
    notes = (
        "Intervals allow for autocorrelated residuals; they say nothing of physics that is still missing.",
    )
    title = f"Estimates from {listed(data['fitted_records'])} ({data['provenance']})"
    return Table(title, header, tuple(rows), notes, words=(0, 5))


def _interval(parameter: Data | None) -> tuple[str, str]:
    if parameter is None:
        return "–", ""
    low, high = parameter["interval_95"]
    interval = "unknown" if low is None or high is None else f"{low:.5g} to {high:.5g}"
    flags = (
        " (at bound)" if parameter["at_bound"] else "" if parameter["identifiable"] else " (not identifiable)"
    )
    return f"{parameter['value']:.5g}".replace("-", "−"), interval.replace("-", "−") + flags


def _refused(data: Data) -> tuple[Table, ...]:
    header = ("effect", "port", "gain", "p", "decision", "reason")
    rows = tuple(
        (r["effect"], r["port"], share(r["gain"]), probability(r["p_value"]), r["status"], r["reason"])
        for r in data["rejected"]
    )
    title = f"Tried and not accepted: {len(rows)}, as last judged ({data['provenance']})"
    return (Table(title, header, rows, words=(0, 1, 4, 5)),) if rows else ()


def _remaining(data: Data, pictures: tuple[Picture, ...]) -> Section:
    header = ("port", "over", "declared model", "augmented model", "p of the latter")
    before = {(c["port"], c["over"]): c for c in data["ceilings"]["declared"]}
    rows = tuple(
        (
            c["port"],
            c["over"],
            share(before[c["port"], c["over"]]["gain"]),
            share(c["gain"]),
            probability(c["p_value"]),
        )
        for c in data["ceilings"]["augmented"]
    )
    tables = (
        [Table("Error that a learned effort would take away", header, rows, words=(0, 1))] if rows else []
    )
    floors = ", ".join(
        f"{name} {quantity(f['value'], f['unit'], 3)}" for name, f in data["noise_floor"].items()
    )
    left = (
        f"Structure remains {listed(data['remains'])}: a learned effort there still lowers the held-out "
        f"error by {data['rules']['worth']:.0%} or more, and no effect in the library does."
        if data["remains"]
        else "No learned effort over velocity or position takes as much from the held-out error as is asked."
    )
    return Section("What is left", (left, f"Noise floor of the sensors: {floors}."), tuple(tables), pictures)


def _rules(data: Data) -> Table:
    rules = data["rules"]
    rows = (
        ("horizons", f"{data['split']}; {data['horizon']:g} s each, {data['horizons'][0]} fitted, "
                     f"{data['horizons'][1]} held out"),
        ("records", listed([f"{r['name']} ({r['provenance']}, {r['source']})" for r in data["records"]])),
        ("significant", f"adjusted p at most {rules['alpha']:g} over all effects tried in a step"),
        ("worth having", f"held-out RMSE lower by {rules['worth']:.0%} or more"),
        ("alike", f"effects whose errors differ by less than {rules['tie']:.0%}, or not significantly"),
        ("identifiable", f"standard errors at most {rules['vague']:.0%} of the value, correlations at most "
                         f"{rules['collinear']:g}"),
        ("search ended", data["stopped"]),
        ("took", f"{data['seconds']:.0f} s on {data['processes']} processes"),
    )  # fmt: skip
    return Table("Rules", ("", ""), rows, words=(0, 1))


def _use(data: Data) -> Section | None:
    if not data["accepted"]:
        return None
    text = "The augmented model is a model like any other: fit, validate and plot take it up."
    return Section("How to go on", (text,), commands=tuple(data["commands"]))


def _key(row: Data) -> tuple[str, str, str]:
    return row["record"], row["output"], row["view"]


def _view(row: Data) -> str:
    return f"horizons of {row['horizon']:g} s" if row["view"] == "horizon" else "free run"


def _change(before: float | None, after: float | None) -> str:
    if not before or after is None:
        return ""
    return f"{100 * (after / before - 1):+.1f} %".replace("-", "−")


def _r2(row: Data) -> str:
    return "" if row["r2"] is None else f"{row['r2']:.6f}".replace("-", "−")


def _mse(row: Data) -> str:
    return "" if row["mse"] is None else f"{row['mse']:.3g} ({row['unit']})²"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
