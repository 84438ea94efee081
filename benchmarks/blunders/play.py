"""One draw fitted and judged: what was told before any parameter was shown."""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.blunders.draw import drawn
from hybridid.estimators import fit
from hybridid.quality import judge

REFUSED = "refused"
CAUSES = {"sign": {"sign"}, "unit": {"unit"}, "swapped": {"swapped"}, "missing": {"incomplete"}}
"""Findings that name the cause; a wrong plant has none of its own."""


@dataclass(frozen=True)
class Outcome:
    """The ``verdict`` on a draw, or "refused" where the fit ended with a message, and what was found."""

    kind: str
    number: int
    machine: str
    planted: str
    verdict: str
    findings: tuple[str, ...]

    @property
    def told(self) -> bool:
        """Whether words spoke against the fit. That a lower valley was taken is no objection."""
        return self.verdict != "sound" or any(one != "valley" for one in self.findings)

    @property
    def cause(self) -> bool:
        """Whether the right cause was named."""
        return bool(CAUSES.get(self.kind, set()) & set(self.findings))


def played(kind: str, number: int, seed: int) -> Outcome:
    """The draw ``number`` of a kind, fitted as its case has it, and judged."""
    case = drawn(kind, number, seed)
    about = (kind, number, case.machine, case.planted)
    try:
        estimate = fit(case.model, case.records, case.settings)
    except ValueError as refused:
        return Outcome(*about, REFUSED, (str(refused),))
    quality = judge(case.model, case.records, estimate)
    return Outcome(*about, quality.verdict, tuple(f.kind for f in quality.findings))
