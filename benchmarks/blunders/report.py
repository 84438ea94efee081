"""What the study found, as Markdown and JSON. Everything is simulated."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from benchmarks import studies
from benchmarks.blunders.draw import KINDS, SOUND
from benchmarks.blunders.play import Outcome


def table(rows: Sequence[Outcome]) -> str:
    """The shares by kind, then every draw that was not told, or accused."""
    cells = []
    for kind in (*KINDS, SOUND):
        own = [r for r in rows if r.kind == kind]
        cause = "" if kind in ("plant", SOUND) else sum(r.cause for r in own)
        cells.append((kind, len(own), sum(r.told for r in own), cause))
    lines = [
        "Planted blunders and sound records (simulated): what was told before a parameter was shown.",
        "",
    ]
    lines += studies.table(("kind", "draws", "told", "right cause"), cells)
    planted, sound = [r for r in rows if r.kind != SOUND], [r for r in rows if r.kind == SOUND]
    lines += ["", f"told: {sum(r.told for r in planted)} of {len(planted)} (asked: 95 %)"]
    lines += [f"false alarms: {sum(r.told for r in sound)} of {len(sound)} (asked: at most 3 %)", ""]
    wrong = [r for r in rows if r.told == (r.kind == SOUND)]
    lines += [
        f"- {r.kind} {r.number}, {r.machine}, {r.planted or 'nothing'}: {r.verdict} {r.findings}"
        for r in wrong
    ]
    return "\n".join(lines)


def write(rows: Sequence[Outcome], seed: int) -> Path:
    """``blunders.md`` and ``blunders.json``, each whole or not at all."""
    data = {"provenance": "simulated", "seed": seed, "rows": [asdict(r) for r in rows]}
    studies.write(studies.OUT / "blunders.json", json.dumps(data, indent=1))
    return studies.write(studies.OUT / "blunders.md", table(rows))
