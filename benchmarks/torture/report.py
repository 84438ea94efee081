"""``docs/reliability.md``: what was tried, at which commit, what broke, and with which seed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from benchmarks.studies import table
from benchmarks.torture.bench import KINDS, Line, Part

There = Mapping[Part, Mapping[str, Line]]
"""The lines of each part, by the keys of its trials."""


def write_report(there: There, page: Path, seed: int) -> str:
    """Write the page; returns what to print."""
    lines = [line for found in there.values() for line in found.values()]
    if not lines:
        return "torture: no trial is done yet, no page written"
    page.write_text(text(there, seed), encoding="utf-8")
    broke = sum(bool(line["faults"]) for line in lines)
    return f"torture: {len(lines)} trials, {broke} of them with a fault: {page}"


def text(there: There, seed: int) -> str:
    """The page in Markdown."""
    lines = [line for found in there.values() for line in found.values()]
    done = [line for line in lines if not line["skipped"]]
    sections = [LEAD, _run(there, seed), _faults_in_all(there, done)]
    for part, found in there.items():
        own = [line for line in found.values() if not line["skipped"]]
        sections += [_section(part, own)] if own else []
    sections += [_broken(done), _broke_before(done), _skipped(lines)]
    return "\n\n".join(section for section in sections if section) + "\n"


LEAD = """# Reliability
`make torture` wrote this page from its results. All records are simulated.

- `make torture ARGS='--only kills'` runs one part.
- `make torture ARGS='--match "kills: fit"'` runs the trials whose names contain these words.
- `make torture ARGS=--report` writes the page and runs nothing.

A run goes on where the last one stopped. It repeats trials of other code unless it is given `--any-code`. A
trial that broke is repeated, and counts by its last run."""


def _run(there: There, seed: int) -> str:
    """Which parts were run, how far, and on what."""
    rows = []
    for part, found in there.items():
        lines = found.values()
        rows.append(
            (
                part.name,
                f"{len(lines)} of {len(part.trials(seed))}" if lines else "not run",
                _joined(line["commit"] for line in lines),
                _joined(line["date"] for line in lines),
                _joined(line["machine"] for line in lines),
                f"{sum(line['seconds'] for line in lines) / 60:.0f}",
            )
        )
    header = ("part", "trials done", "commit", "date", "machine", "minutes")
    return "\n".join(
        ["## What was run", f"The seed of all that was drawn is {seed}.", "", *table(header, rows)]
    )


def _faults_in_all(there: There, done: Sequence[Line]) -> str:
    """Of the kinds that the parts that were run look for."""
    faults = _faults(done)
    sought = {kind for part, lines in there.items() if lines for kind in part.seeks} | set(faults)
    rows = [(kind, str(faults[kind])) for kind in KINDS if kind in sought]
    return "\n".join([f"## Faults in all {len(done)} trials", *table(("fault", "trials"), rows)])


def _section(part: Part, lines: Sequence[Line]) -> str:
    counted, found = _counted(lines), _faults(lines)
    least = {what: f", at least {n} are asked" for what, n in part.asked.items()}
    total = [f"- {n:,.0f} {what}{least.get(what, '')}" for what, n in counted.items()]
    kinds = [kind for kind in KINDS if kind in part.seeks or found[kind]]
    rows = []
    for category in dict.fromkeys(line["category"] for line in lines):
        own = [line for line in lines if line["category"] == category]
        faults = _faults(own)
        seconds = sum(line["seconds"] for line in own)
        rows.append((category, str(len(own)), *(str(faults[kind]) for kind in kinds), f"{seconds:.0f}"))
    shown = table(("", "trials", *kinds, "seconds"), rows)
    return "\n".join([f"## {part.name.capitalize()}", part.about, "", *total, "", *shown])


def _counted(lines: Iterable[Line]) -> Mapping[str, float]:
    found: dict[str, float] = {}
    for line in lines:
        for what, n in line["counts"].items():
            found[what] = found.get(what, 0) + n
    return found


def _faults(lines: Iterable[Line]) -> Counter[str]:
    """How many trials had a fault of each kind."""
    return Counter(kind for line in lines for kind in {fault["kind"] for fault in line["faults"]})


def _broken(done: Sequence[Line]) -> str:
    rows = [f"- {line['key']}: {fault['kind']}: {fault['what']}" for line in done for fault in line["faults"]]
    return "## What broke\n" + "\n".join(rows or ["Nothing."])


def _broke_before(done: Sequence[Line]) -> str:
    """Trials whose last run is sound, and an earlier one was not."""
    kinds = {line["key"]: {fault["kind"] for fault in line.get("earlier", ())} for line in done}
    rows = [f"- {key}: {', '.join(sorted(found))}" for key, found in kinds.items() if found]
    lead = "A fault was hybridid's, or the torture's own that took what is sound for a fault."
    return "\n".join(["## What broke in an earlier run", lead, "", *rows]) if rows else ""


def _skipped(lines: Sequence[Line]) -> str:
    why = Counter((line["part"], line["skipped"]) for line in lines if line["skipped"])
    rows = [f"- {part}: {n} trials: {reason}" for (part, reason), n in why.items()]
    return "## Not tried on this machine\n" + "\n".join(rows) if rows else ""


def _joined(values: Iterable[str]) -> str:
    """Each value once, the most frequent first."""
    return "; ".join(value for value, _ in Counter(values).most_common())
