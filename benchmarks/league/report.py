"""The league's page: what was asked and what came out, by category and player, with its confusion matrix."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from benchmarks.answers import ORACLE, Line
from benchmarks.bars import Bar, bars_table
from benchmarks.league.figures import confusion, gains
from benchmarks.league.ours import NAME
from benchmarks.league.scoring import EMPTY, Round, Tally, asked, rounds, tallies
from hybridid.plotting.style import save
from hybridid.quantities import NONE, number, percent, probability
from pipelines.shared.page import Page, Picture, Section, Table


def write_report(lines: Sequence[Line], folder: Path) -> str:
    """Write ``index.html``, ``index.md``, ``league.json`` and the figures; returns what to print."""
    found = rounds(lines)
    if not found:
        return "league: no answer beside the oracle's yet, no page written"
    oracle = {line["key"]: line["answer"] for line in lines if line["player"] == ORACLE and line["answer"]}
    targets, table = asked(found, NAME), tallies(found)
    pictures = []
    for player in sorted({r.player for r in found}):
        plot = confusion([r for r in found if r.player == player and r.counts], player)
        pictures.append(Picture(save(plot, folder)[0], plot.caption))
    plot = gains(found, oracle)
    pictures.append(Picture(save(plot, folder)[0], plot.caption))
    page = _page(found, oracle, targets, table, pictures).write(folder)
    data = {
        "provenance": "simulated",
        "asked": [asdict(line) for line in targets],
        "tallies": {c: {p: asdict(t) for p, t in by.items()} for c, by in table.items()},
        "scenarios": sorted({r.key for r in found}),
    }
    (folder / "league.json").write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    return f"{_printed(targets, table)}\n{page}"


def _page(
    found: Sequence[Round],
    oracle: dict,
    targets: Sequence[Bar],
    table: dict[str, dict[str, Tally]],
    pictures: Sequence[Picture],
) -> Page:
    keys = {r.key for r in found}
    unseen = [key for key in keys if key in oracle and not oracle[key]["detectable"]]
    lead = (
        f"{len(keys)} simulated experiments hide an effect that no declared model has, or nothing; each "
        "player gets the same two records and the declared model."
    )
    rules = (
        "All data are simulated by virtual rigs, whose truth is integrated by other code than any player's.",
        "An effect of the library counts where an oracle, which is told the true structure and starts from "
        f"the true values, explains the held-out record better at p < 0.001: {len(unseen)} planted effects "
        "do not and are left out of the shares.",
        "Named means the right effect at the right port. Our trace reports classes of effects that the "
        "records cannot tell apart; a rival's class is what it named first.",
    )
    return Page(
        "The league",
        lead,
        (
            Section("What was asked", rules, (bars_table(targets, "Targets (simulated)"),)),
            Section("By category", (), tuple(_category_table(c, by) for c, by in table.items())),
            Section("Planted and named", (), (), tuple(pictures)),
            Section("Where ours failed", (), (_failures(found),)),
            Section("Every scenario", (), (_all(found, oracle),)),
        ),
        marks=("simulated",),
    )


def _category_table(category: str, by: dict[str, Tally]) -> Table:
    header = (
        "player", "scenarios", "named first", "or in class", "abstained", "class size", "parameter error",
        "error before", "after", "CPU s",
    )  # fmt: skip
    rows = tuple(
        (
            player, str(t.scenarios), str(t.top), str(t.covered), str(t.abstained),
            number(t.class_size, 3, NONE), percent(t.parameter_error, 1, NONE),
            *(number(x, 3, NONE) for x in (t.before, t.after, t.seconds)),
        )
        for player, t in by.items()
    )  # fmt: skip
    note = "medians; errors over the spread of what the player predicts: output over horizons, or effort"
    right = "named first: named nothing, as is right here" if category in EMPTY else ""
    return Table(
        f"{category.replace('_', ' ')} (simulated)", header, rows, tuple(n for n in (note, right) if n)
    )


def _failures(found: Sequence[Round]) -> Table:
    rows = tuple(
        (r.key, ", ".join(r.answer["named"]) or "nothing", _why(r))
        for r in found
        if r.player == NAME and r.counts and not r.covered
    )
    header = ("scenario", "named", "what became of the truth")
    return Table("Ours, wrong (simulated)", header, rows, words=(0, 1, 2))


def _why(r: Round) -> str:
    """What the first step said of what was planted."""
    steps = r.answer["notes"].get("steps") or [[]]
    for trial in steps[0]:
        if trial["name"] == r.truth:
            return f"{trial['status']}: {trial['reason']}"
    return f"{r.answer['notes']['verdict']}; {r.answer['notes']['stopped']}"


def _all(found: Sequence[Round], oracle: dict) -> Table:
    players = sorted({r.player for r in found})
    by_key: dict[str, dict[str, Round]] = {}
    for r in found:
        by_key.setdefault(r.key, {})[r.player] = r
    rows = []
    for key, answers in sorted(by_key.items()):
        said = oracle.get(key)
        seen = NONE if said is None else f"p {probability(said['p_value'], '= ')}, {percent(said['gain'], 0)}"
        rows.append((key, seen, *(_mark(answers.get(p)) for p in players)))
    header = ("scenario", "oracle", *players)
    title = "Answers (simulated); ✓ right, (✓) in the class"
    return Table(title, header, tuple(rows), words=tuple(range(len(header))))


def _mark(r: Round | None) -> str:
    if r is None:
        return ""
    mark = "✓" if r.top else "(✓)" if r.covered else "✗"
    return f"{mark} {', '.join(r.answer['named'][:3]) or 'nothing'}"


def _printed(targets: Sequence[Bar], table: dict[str, dict[str, Tally]]) -> str:
    lines = ["league (simulated): right answers, first or in the class, of those that count"]
    players = sorted({p for by in table.values() for p in by})
    lines.append(f"  {'':16}" + "".join(f"{p:>24}" for p in players))
    for category, by in table.items():
        cells = "".join(f"{f'{by[p].covered} of {by[p].scenarios} ({by[p].top} first)':>24}" for p in players)
        lines.append(f"  {category:16}{cells}")
    return "\n".join([*lines, *(bar.line for bar in targets)])
