"""Whole traces over the whole library: what they say, how long they take, and where the time goes."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from benchmarks.speed.row import OURS, Row
from hybridid.records.record import Record
from hybridid.signals.steps import apply_steps
from hybridid.trace.results.result import Trace
from hybridid_cli.composing import settings_of
from pipelines.shared.sources import sources_of
from pipelines.trace.request import division, request_of
from pipelines.trace.stage import traced

TRACES = "traces over the whole library"
CASES = {
    "EMPS": ("emps", ()),
    "Silverbox": ("silverbox", ()),
    "servo, 12 recordings": ("servo", ()),
    "flexible link": ("flexible_link", ()),
    "eSEA, 30 s": ("esea", ("data=simulated", "rig.duration=30.0")),
    "half-car": ("vehicle", ("data=simulated",)),
}
QUICK = {"EMPS, 8 s": ("emps", ("data=simulated", "rig.duration=8.0", "trace.effects=[asymmetric_viscous]"))}


@dataclass
class _Clock:
    """Where the time goes: the seconds until each report, by its stage, and how many there were."""

    last: float = field(default_factory=time.perf_counter)
    seconds: dict[str, float] = field(default_factory=dict)
    reports: int = 0

    def __call__(self, stage: str, done: int, of: int, what: str) -> None:
        """A trace's report."""
        now = time.perf_counter()
        self.seconds[stage] = self.seconds.get(stage, 0.0) + now - self.last
        self.last = now
        self.reports += 1


def traces(repeats: int, say: Callable[[str], None], quick: bool) -> Iterator[Row]:
    """Each once, on all cores; figures and files are not made."""
    for what, (name, words) in (QUICK if quick else CASES).items():
        say(what)
        found, clock, records = _traced(name, *words)
        names = ", ".join(one.name for one in found.accepted) or "nothing"
        say(f"  {found.seconds:.0f} s: {found.verdict}, {names}")
        yield Row(
            TRACES,
            what,
            OURS,
            (found.seconds,),
            f"{found.verdict}: {names}; {found.times:.1f} times the noise left",
            " and ".join(sorted({r.provenance for r in records})),
            details={**clock.seconds, "reports a minute": 60 * clock.reports / found.seconds},
        )


def _traced(name: str, *words: str) -> tuple[Trace, _Clock, list[Record]]:
    settings = settings_of([f"case={name}", *words], "trace")
    steps = settings["preprocess.steps"]
    fitted, held_out = (
        [apply_steps(source.record(), steps) for source in part]
        for part in division(sources_of(settings).found, settings)
    )
    clock = _Clock()
    found = traced(settings, request_of(settings), fitted, held_out, clock)
    return found, clock, fitted + held_out
