"""The page of the measured league: what was said of each record, beside what its publishers found."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

from benchmarks.measured.entry import Entry
from benchmarks.measured.play import Outcome, named
from hybridid.naming import listed
from hybridid.quantities import number, quantity
from pipelines.shared.page import Page, Section, Table

HEADER = (
    "declared", "verdict", "what it names", "is what is known among it?", "horizons, before", "after",
    "free run, before", "after", "times the noise", "seconds",
)  # fmt: skip
WORDS = (0, 1, 2, 3)


def write_report(found: Sequence[Outcome], folder: Path, seconds: float) -> str:
    """Write ``index.html`` and ``index.md``; returns a line for each trace and where the page is."""
    marks = tuple(sorted({one.found.provenance for one in found if one.found}))
    lead = (
        "Each record is traced with the effects that its case declares, and with each of them left out in "
        f"turn. {_counted(found)} All traces together took {number(seconds / 60, 3)} minutes."
    )
    folder.mkdir(parents=True, exist_ok=True)
    groups = groupby(found, key=lambda one: one.asked.entry)
    page = Page(
        "The measured league", lead, tuple(_section(entry, list(own)) for entry, own in groups), marks
    )
    return "\n".join([*map(line, found), str(page.write(folder))])


def line(one: Outcome) -> str:
    """One trace in one line."""
    if one.found is None:
        return f"{one.asked.key}: {one.failure}"
    names = listed([named(entry) for entry in one.found.accepted])
    horizons = " -> ".join(quantity(value, one.unit) for value in one.held_out)
    free = " -> ".join(quantity(value, one.unit) for value in one.free_run)
    said = f"{one.found.verdict}: {names} (known: {one.hit}); horizons {horizons}, free run {free}"
    return f"{one.asked.key} ({one.found.provenance}): {said}, {number(one.found.seconds, 3)} s"


def _counted(found: Sequence[Outcome]) -> str:
    """How often what was left out, or what others found missing, is named."""
    ended = [one for one in found if one.found]
    hits = [one.hit for one in ended]
    near = sum(hit not in ("first", "no") for hit in hits)
    return (
        f"Of {len(ended)} traces, {hits.count('first')} name first an effect that is known to be missing, "
        f"{near} name it later or in a class of effects that the record cannot tell apart, and "
        f"{hits.count('no')} do not name it."
    )


def _section(entry: Entry, own: Sequence[Outcome]) -> Section:
    failures = [f"{one.asked.label}: {one.failure}" for one in own if one.found is None]
    rows = tuple(_row(one) for one in own if one.found)
    about = [f"What its publishers found: {entry.published.physics}."]
    if entry.published.error is not None and rows:
        unit = next(one.unit for one in own if one.found)
        told = quantity(entry.published.error, unit)
        about.append(
            f"The best published free run leaves {told} ({entry.published.of}; {entry.published.source})."
        )
    marks = " and ".join(sorted({one.found.provenance for one in own if one.found}))
    caption = (
        f"Held-out errors of {entry.judge.output} ({marks}): RMSE over horizons, "
        f"{entry.judge.measure.upper()} in free run. Known to be missing where all is declared: "
    )
    tables = (Table(caption + " or ".join(entry.lacks), HEADER, rows, words=WORDS),) if rows else ()
    return Section(entry.title, (*about, *failures), tables)


def _row(one: Outcome) -> tuple[str, ...]:
    assert one.found is not None
    errors = (quantity(value, one.unit) for value in (*one.held_out, *one.free_run))
    names = listed([named(entry) for entry in one.found.accepted])
    times, seconds = number(one.found.times, 3), number(one.found.seconds, 3)
    return (one.asked.label, one.found.verdict, names, one.hit, *errors, times, seconds)
