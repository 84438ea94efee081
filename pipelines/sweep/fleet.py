"""``fleet.json``, ``fleet.csv`` and the page of many traces: a line for each machine.

The counts show what the machines of a fleet have in common: an effect in most of them belongs to the model,
an effect in one of them to that machine.
"""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from hybridid.naming import counted, listed
from hybridid.quantities import NONE, number, quantity
from hybridid.trace.entries import AcceptedEffect
from hybridid.trace.words.remarks import parameters_in_words
from hybridid.trace.words.words import VERDICTS
from pipelines.shared.page import Page, Section, Table
from pipelines.shared.side_by_side import results_folder
from pipelines.shared.storage import json_text
from pipelines.shared.traced import trace_of
from pipelines.shared.tree import write_text
from pipelines.sweep.conduct import SweepOutcome
from pipelines.sweep.point import Point, axes_of, spelt
from pipelines.sweep.results import Coordinates, FailedPoint, failed_points, place_of
from pipelines.sweep.words import axis_name, failed_section, quoted
from pipelines.trace.stage import TRACE

NAME = "fleet"
_COLUMNS = (
    "verdict", "lacks", "output", "unit", "held_out_rmse_before", "held_out_rmse_after", "times_the_noise",
    "seconds", "provenance", "tree",
)  # fmt: skip


@dataclass(frozen=True)
class Machine:
    """What the trace of one point says.

    ``at`` are its coordinates and ``tree`` its run tree, seen from the file. ``lacks`` names what was
    accepted, each with what the records cannot tell from it; ``values`` are the parameters of these effects
    in words. ``before`` and ``after`` are the held-out RMSE by output, in its unit of ``units``; ``times`` is
    the error left over that of noise and simulation.
    """

    at: Coordinates
    tree: str
    provenance: str
    verdict: str
    lacks: tuple[str, ...]
    values: tuple[str, ...]
    before: Mapping[str, float]
    after: Mapping[str, float]
    units: Mapping[str, str]
    times: float
    seconds: float
    sentence: str


@dataclass(frozen=True)
class Fleet:
    """The traces of a sweep called ``name`` over ``axes``, asked for by ``words``, in ``seconds``.

    ``verdicts`` and ``lacks`` say of how many machines.
    """

    name: str
    words: tuple[str, ...]
    axes: tuple[str, ...]
    seconds: float
    verdicts: Mapping[str, int]
    lacks: Mapping[str, int]
    machines: tuple[Machine, ...]
    failures: tuple[FailedPoint, ...]


def fleet_of(swept: SweepOutcome) -> Fleet:
    """All that ``fleet.json`` says."""
    sweep = swept.sweep
    machines = tuple(_machine(point, swept) for point in swept.done)
    return Fleet(
        name=sweep.name,
        words=tuple(sweep.words),
        axes=tuple(axes_of(sweep.points)),
        seconds=swept.seconds,
        verdicts=_most_first(one.verdict for one in machines),
        lacks=_most_first(name for one in machines for name in one.lacks),
        machines=machines,
        failures=failed_points(swept),
    )


def write_fleet(swept: SweepOutcome) -> Fleet:
    """Write the numbers, then the pages that show them."""
    found, folder = fleet_of(swept), swept.sweep.folder
    write_text(folder / f"{NAME}.json", json_text(found))
    write_text(folder / f"{NAME}.csv", _csv(found))
    page_of(found, swept).write(folder)
    return found


def header(found: Fleet) -> tuple[str, ...]:
    """Of the table of machines."""
    what = ("verdict", "lacks", "held-out RMSE before", "after", "times the noise", "seconds", "data")
    return (*map(axis_name, found.axes), *what)


def line(one: Machine, found: Fleet) -> tuple[str, ...]:
    """A machine as a row of that table."""
    return (
        *(spelt(one.at.get(key)) for key in found.axes),
        VERDICTS[one.verdict],
        listed(one.lacks) if one.lacks else NONE,
        _errors(one.before, one.units),
        _errors(one.after, one.units),
        number(one.times, 2),
        number(one.seconds, 3),
        one.provenance,
    )


def counts(found: Fleet) -> tuple[str, ...]:
    """How many machines have each verdict, and lack each effect, in words."""
    of = len(found.machines)
    verdicts = listed([f"{VERDICTS[word]}: {count}" for word, count in found.verdicts.items()])
    lacks = [f"{name}: {count} of {of}" for name, count in found.lacks.items()]
    said = (f"{counted(of, 'machine')}, {verdicts}.",) if of else ()
    return (*said, *((f"What they lack: {listed(lacks)}.",) if lacks else ()))


def page_of(found: Fleet, swept: SweepOutcome) -> Page:
    """The page: counts, a row for each machine, what each lacks with its values, failures, the command."""
    marks = tuple(sorted({word for one in found.machines for word in one.provenance.split(" and ")}))
    names, words = header(found), len(found.axes)
    rows = tuple(line(one, found) for one in found.machines)
    table = Table(f"Machines ({' and '.join(marks)})", names, rows, words=(*range(words + 2), len(names) - 1))
    said = tuple(f"{_named(one, found)}: {one.sentence}" for one in found.machines)
    reports = tuple(
        (_named(one, found), "; ".join(one.values) or NONE, f"{one.tree}/trace/report.html")
        for one in found.machines
    )
    detail = Table(
        "What each lacks, and its report", ("", "values ± 95 %", "report"), reports, words=(0, 1, 2)
    )
    sections = [
        Section("Machines", counts(found), (table, detail) if rows else ()),
        Section("In words", said),
    ]
    sections += failed_section(swept, "Machines without a trace")
    again = [quoted(word.lstrip("+")) for word in found.words if not word.startswith("sweep.stage=")]
    sections.append(Section("Again", commands=(f"hybridid trace -m {' '.join(again)}",)))
    lead = f"{len(found.machines)} of {counted(len(swept.sweep.points), 'machine')} traced."
    return Page(f"Fleet: {found.name}", lead, tuple(sections), marks)


def _machine(point: Point, swept: SweepOutcome) -> Machine:
    found = trace_of(point.tree, results_folder(TRACE, point.settings, point.tree)).found
    first, last = found.path[0].held_out_rmse, found.path[-1].held_out_rmse
    return Machine(
        at=dict(point.at),
        tree=place_of(point, swept.sweep.folder),
        provenance=found.provenance,
        verdict=found.verdict,
        lacks=tuple(map(_class, found.accepted)),
        values=tuple(", ".join((one.effect, *parameters_in_words(one.parameters))) for one in found.accepted),
        before=dict(first),
        after=dict(last),
        units={row.output: row.unit for row in found.before},
        times=found.times,
        seconds=found.seconds,
        sentence=found.words,
    )


def _class(one: AcceptedEffect) -> str:
    """``carriage.stribeck``, or all members of its class in one order, so that equal classes read alike."""
    members = [one.name, *(name for name in one.others)]
    return one.name if len(members) == 1 else f"one of {{{', '.join(sorted(members))}}}"


def _errors(rmse: Mapping[str, float], units: Mapping[str, str]) -> str:
    """The RMSE of the one output, or of each with its name."""
    if len(rmse) == 1:
        ((output, value),) = rmse.items()
        return quantity(value, units[output])
    return ", ".join(f"{output} {quantity(value, units[output])}" for output, value in rmse.items())


def _most_first(names: Iterable[str]) -> dict[str, int]:
    return dict(Counter(names).most_common())


def _named(one: Machine, found: Fleet) -> str:
    return ", ".join(f"{axis_name(key)}={spelt(one.at.get(key))}" for key in found.axes) or found.name


def _csv(found: Fleet) -> str:
    """A row for each output of each machine."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*found.axes, *_COLUMNS])
    for one in found.machines:
        at = [spelt(one.at.get(key)) for key in found.axes]
        for output in one.before:
            errors = [one.units[output], one.before[output], one.after[output]]
            rest = [one.times, one.seconds, one.provenance, one.tree]
            writer.writerow([*at, one.verdict, " and ".join(one.lacks), output, *errors, *rest])
    return text.getvalue()
