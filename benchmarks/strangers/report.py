"""What the study found, as Markdown, with simulated or measured beside it."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.strangers.asked import COMMANDS, LONGEST, Answer
from benchmarks.strangers.killed import Killed
from benchmarks.strangers.play import SECONDS, Outcome, Value
from benchmarks.strangers.servo import ALLOWED, Servo
from benchmarks.studies import table
from hybridid.quantities import estimated, fixed, number, percent, quantity

HEAD = ("machine", "template", "commands", "lines of Python", "new, run, trace [s]", "CPU [s]")


def row(one: Outcome) -> tuple[str, ...]:
    """One machine as a row of its table."""
    wall = ", ".join(f"{seconds:.0f}" for seconds in one.wall)
    cells = (one.machine.name, one.machine.template, str(len(one.wall)), str(one.python), wall)
    sentence = one.sentence if one.report else f"{one.sentence} (no page)"
    return (*cells, f"{sum(one.cpu):.0f}", _parameters(one), sentence)


def _parameters(one: Outcome) -> str:
    """The largest error of a parameter, or where more was planted than declared, each parameter."""
    if not one.machine.planted:
        return f"{percent(one.values[one.worst].off, 2)} ({one.worst})" if one.worst else "–"
    said = [_found(name, value) for name, value in one.values.items()]
    return "; ".join([*said, *(f"{name}: not in the model" for name in one.lacking)])


def _found(name: str, value: Value) -> str:
    found = estimated(value.found, value.std, value.unit)
    return f"{name} {found} (planted: {quantity(value.planted, value.unit)})"


def templates(rows: Sequence[Outcome]) -> str:
    """The templates' own machines, and how many keep what issue 19 asks."""
    title = (
        "## Each template, from the recording to the traced report (simulated)\n"
        f"{SECONDS:g} s at 500 Hz; slow machines at 1 Hz or slower, as many samples. "
        "Nothing is missing in these."
    )
    return _machines(title, "largest error of a planted parameter", rows)


def rigs(rows: Sequence[Outcome]) -> str:
    """The machines that hold more than their template declares."""
    title = "## Machines that hold more than their template declares (simulated)"
    return _machines(title, "found, and planted", rows)


def _machines(title: str, parameters: str, rows: Sequence[Outcome]) -> str:
    """Each machine, and how many of them keep each limit."""
    quick = sum(sum(one.wall) <= LONGEST for one in rows)
    few = sum(len(one.wall) <= COMMANDS for one in rows)
    without = sum(one.python == 0 for one in rows)
    written = sum(one.report for one in rows)
    kept = (
        f"Of {len(rows)} machines (simulated): at most {LONGEST:g} s {quick}, at most {COMMANDS} commands "
        f"{few}, no line of Python {without}, a page of the trace {written}."
    )
    return "\n".join([title, "", *table((*HEAD, parameters, "verdict"), map(row, rows)), "", kept])


def servo(found: Servo | None) -> str:
    """The servo as a stranger writes it; None: the measured records are not at hand."""
    head = "## The servo of `case=servo`, written with `hybridid new` (measured)\n"
    if found is None:
        return head + "**Skipped**: the measured records are not at hand. Set HYBRIDID_DATA to their folder."
    both = found.python + found.case
    wall, cpu = (fixed(sum(part), 0) for part in (found.wall, found.cpu))
    return "\n".join(
        [
            head,
            f"{both} lines beyond the template (at most {ALLOWED}): {found.python} of Python, {found.case} "
            f"of the case. {found.commands} commands: {wall} s, {cpu} s of CPU. k_p and U are constants of "
            f"each recording. Largest difference from the packaged case: {percent(found.apart, 4)}.",
            "",
            *table(
                ("measured", "by `new`", "packaged"),
                [
                    *((name, *map(number, pair)) for name, pair in found.parameters.items()),
                    *(
                        (f"free run of {record}", *(quantity(one, "rad") for one in pair))
                        for record, pair in found.rmse.items()
                    ),
                ],
            ),
        ]
    )


def killed(found: Killed) -> str:
    """What became of the trace that was killed and started again."""
    struck = found.struck
    most = max((found.twice(one) for one in struck), default=0)
    same = sum(one.same_verdict and one.same_numbers for one in struck)
    return "\n".join(
        [
            "## A trace that is killed at a random moment and started again (simulated)",
            f"In peace: {found.refits} refits in {found.seconds:.0f} s, one process. {found.sentence}",
            "",
            *table(
                ("killed after", "refits begun", "after the new start", "done twice", "verdict and numbers"),
                [
                    (
                        percent(one.share, 0),
                        one.before,
                        one.after,
                        found.twice(one),
                        "the same" if one.same_verdict and one.same_numbers else "**differ**",
                    )
                    for one in struck
                ],
            ),
            "",
            f"{len(struck)} kills (SIGKILL), at most {most} refits done twice, the same verdict and numbers "
            f"after {same}. In n processes, n refits are under way at a time, and each may be done twice.",
        ]
    )


def answers(found: Sequence[Answer]) -> str:
    """Each line that must be shown, with what was found."""
    rows = [(one.asked, "yes" if one.holds else "**no**", one.found, one.data) for one in found]
    shown = table(("asked (issue 19)", "holds", "found", "data"), rows)
    return "\n".join(["## What must be shown", "", *shown])


def page(found: Sequence[Answer], sections: Sequence[str]) -> str:
    """The page: the answers, then all ``sections``."""
    head = "# A stranger's machine: from a recording to a traced model"
    return "\n\n".join([head, answers(found), *sections])
