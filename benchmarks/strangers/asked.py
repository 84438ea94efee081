"""What issue 19 asks, line by line, with the answer of the study: in words and numbers, held or not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.strangers.killed import Killed
from benchmarks.strangers.play import Outcome
from benchmarks.strangers.servo import ALLOWED, Servo
from hybridid.naming import listed
from hybridid.quantities import percent
from pipelines.new.template import kinds

LONGEST, COMMANDS = 300.0, 10
"""Seconds and commands that a machine may take."""
TWICE = 1
"""Refits that a kill may repeat."""


@dataclass(frozen=True)
class Answer:
    """A line that must be shown, what was found, and whether it holds."""

    asked: str
    found: str
    data: str
    holds: bool


def of_templates(rows: Sequence[Outcome]) -> Answer:
    """Each template, from the recording to the traced report."""
    left = [kind for kind in kinds() if kind not in {one.machine.template for one in rows}]
    slowest = max(rows, key=lambda one: sum(one.wall))
    bad = [one.machine.name for one in rows if not kept(one)]
    most = max(len(one.wall) for one in rows)
    found = (
        f"{len(rows) - len(bad)} of {len(rows)} machines keep all limits: at most {most} commands, "
        f"{max(one.python for one in rows)} lines of Python; the slowest, {slowest.machine.name}, took "
        f"{sum(slowest.wall):.0f} s, {sum(slowest.cpu):.0f} s of CPU"
    )
    found += f"; beyond a limit: {listed(bad)}" if bad else ""
    found += f"; not played: {listed(left)}" if left else ""
    asked = (
        f"each template: recording to traced report in at most {COMMANDS} commands, no line of Python beyond "
        f"what `new` wrote, at most {LONGEST:g} s; CI runs the commands of docs/your-machine.md "
        "(tests/hybridid_cli/new/test_page.py)"
    )
    return Answer(asked, found, "simulated", not bad and not left)


def kept(one: Outcome) -> bool:
    """Whether a machine keeps every limit, and its report was written."""
    return sum(one.wall) <= LONGEST and len(one.wall) <= COMMANDS and one.python == 0 and one.report


def of_servo(found: Servo | None) -> Answer:
    """The servo of the package, written by a stranger."""
    asked = (
        "`case=servo` written with `hybridid new`, kp and supply as constants of each recording: at most "
        f"{ALLOWED} lines beyond the template"
    )
    if found is None:
        return Answer(asked, "skipped: the measured records are not at hand", "measured", False)
    said = (
        f"{found.python} lines of Python and {found.case} of the case; {found.commands} commands; largest "
        f"difference of a parameter or an error from the packaged case: {percent(found.apart, 4)}"
    )
    return Answer(asked, said, "measured", found.python + found.case <= ALLOWED and found.apart < SAME)


SAME = 1e-3
"""Relative difference up to which two fits of one model are the same."""


def of_rigs(rows: Sequence[Outcome]) -> Answer:
    """Machines that hold more than their template declares: fitted, traced, reported."""
    done = [one for one in rows if one.report]
    named = "; ".join(f"{one.machine.name}: {_first(one.sentence)}" for one in rows)
    asked = (
        "a damper with Dahl friction behind a gap, motion prescribed; a pendulum swinging free; two tanks, "
        "one overflowing: each fitted, traced, reported"
    )
    said = f"{len(done)} of {len(rows)} fitted, traced and reported. {named}"
    return Answer(asked, said, "simulated", len(done) == len(rows) > 0)


def _first(sentence: str) -> str:
    """What the verdict names, without the errors."""
    return sentence.partition(": ")[0]


def of_killed(found: Killed) -> Answer:
    """The trace that was killed and started again."""
    struck = found.struck
    most = max((found.twice(one) for one in struck), default=0)
    same = sum(one.same_verdict and one.same_numbers for one in struck)
    asked = (
        f"a trace killed at any moment and started again: at most {TWICE} refit done twice; the same verdict "
        "and numbers"
    )
    said = (
        f"{len(struck)} of {len(found.trials)} kills struck; at most {most} refit done twice; the same "
        f"verdict and numbers after {same}"
    )
    return Answer(asked, said, "simulated", 0 < len(struck) == same and most <= TWICE)
