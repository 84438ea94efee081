"""``docs/reliability.md``: what was tried, what broke, and with which seeds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.torture.bench import KINDS, Line

ASKED = {"bad inputs": 3000, "kills": 300}
"""How many at least."""


def write_report(lines: Sequence[Line], page: Path, seed: int) -> str:
    """Write the page; returns what to print."""
    if not lines:
        return "torture: no trial is done yet, no page written"
    page.write_text(text(lines, seed), encoding="utf-8")
    broke = sum(bool(line["faults"]) for line in lines)
    return f"torture: {len(lines)} trials, {broke} of them with a fault: {page}"


def text(lines: Sequence[Line], seed: int) -> str:
    """The page in Markdown."""
    done = [line for line in lines if not line["skipped"]]
    parts = dict.fromkeys(line["part"] for line in done)
    sections = [_lead(done, seed), _totals(done)]
    sections += [_part(name, [line for line in done if line["part"] == name]) for name in parts]
    sections += [_faults(done), _skipped(lines)]
    return "\n\n".join(section for section in sections if section) + "\n"


def _lead(done: Sequence[Line], seed: int) -> str:
    dates = sorted({line["date"] for line in done})
    machines = sorted({line["machine"] for line in done})
    codes = Counter(line["version"] for line in done)
    said = ", ".join(f"{code} ({n} trials)" for code, n in codes.most_common())
    when = dates[0] if len(dates) == 1 else f"{dates[0]} to {dates[-1]}"
    return "\n".join(
        [
            "# Reliability",
            "`make torture` wrote this page. All records are simulated. A fault of a trial is one of these: "
            + ", ".join(KINDS) + ".",
            "",
            f"- seed: {seed}. `ARGS='--match KEY'` repeats one trial, by a part of its key.",
            f"- dates: {when}",
            f"- machine: {'; '.join(machines)}",
            f"- digest of the code: {said}",
        ]
    )  # fmt: skip


def _totals(done: Sequence[Line]) -> str:
    counted = _counted(done)
    faults = Counter(fault["kind"] for line in done for fault in line["faults"])
    rows = [
        (what, f"{counted[what]:g}", f"at least {least}") for what, least in ASKED.items() if what in counted
    ]
    rows += [(what, f"{n:g}", "") for what, n in counted.items() if what not in ASKED]
    rows += [(f"trials with the fault: {kind}", str(faults[kind]), "0") for kind in KINDS]
    return "## In all\n" + _table(("what", "count", "asked"), rows)


def _part(name: str, lines: Sequence[Line]) -> str:
    rows = []
    for category in dict.fromkeys(line["category"] for line in lines):
        own = [line for line in lines if line["category"] == category]
        counted = ", ".join(f"{n:g} {what}" for what, n in _counted(own).items())
        rows.append((category, str(len(own)), counted, str(sum(bool(line["faults"]) for line in own))))
    return f"## {name.capitalize()}\n" + _table(("", "trials", "counted", "with a fault"), rows)


def _counted(lines: Sequence[Line]) -> Mapping[str, float]:
    found: dict[str, float] = {}
    for line in lines:
        for what, n in line["counts"].items():
            found[what] = found.get(what, 0) + n
    return found


def _faults(done: Sequence[Line]) -> str:
    rows = [f"- {line['key']}: {fault['kind']}: {fault['what']}" for line in done for fault in line["faults"]]
    return "## What broke\n" + "\n".join(rows or ["Nothing."])


def _skipped(lines: Sequence[Line]) -> str:
    why = Counter((line["part"], line["skipped"]) for line in lines if line["skipped"])
    rows = [f"- {part}: {n} trials: {reason}" for (part, reason), n in why.items()]
    return "## Not tried on this machine\n" + "\n".join(rows) if rows else ""


def _table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
