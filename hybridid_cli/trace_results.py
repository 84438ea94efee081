"""What a trace found, as a person reads it: the verdict first."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import RenderableType
from rich.text import Text

from hybridid.naming import counted
from hybridid.quantities import NONE, UNKNOWN, change, probability, quantity, r_squared, share
from hybridid.trace.results.before_after import FITTED
from hybridid.trace.results.result import Trace
from hybridid.trace.words.remarks import (
    completeness_in_words,
    idle_in_words,
    narrowed_in_words,
    others_in_words,
    parameters_in_words,
    rivals,
    tried_in_words,
    unsure_in_words,
)
from hybridid.trace.words.words import VERDICTS
from hybridid_cli.tables import provenance, table, view
from pipelines.shared.fitted import ESTIMATE, fit_of
from pipelines.shared.traced import trace_of

BLURRED = ("smoothing", "stopped", "valley")
"""Kinds of advice that a wide smoothing of sign(v) calls for, or the rough cost that it makes."""
WRONG_READING = ("sign", "unit", "swapped", "bound")
"""Findings of a fit that are as true of a trace over the same records."""
_COLOURS = {
    "effect_found": "green",
    "ambiguous": "yellow",
    "law_proposed": "yellow",
    "nothing_missing": "green",
    "undecided": "yellow",
    "unexplained": "red",
}


def trace_results(tree: Path, folder: Path | None = None) -> list[RenderableType]:
    """The verdict in one sentence, each caution, what was accepted, before and after, where the files are.

    ``folder`` holds the trace; None: it is the newest of the tree.
    """
    said = trace_of(tree, folder)
    found = said.found
    word = (f"{VERDICTS[found.verdict]}: ", f"bold {_COLOURS[found.verdict]}")
    parts: list[RenderableType] = [Text.assemble(word, found.sentence)]
    parts += [Text(f"- {one}", style="yellow" if one.startswith("Beware") else "") for one in found.cautions]
    parts.append(Text(""))
    if found.accepted:
        parts.append(_accepted(found))
        parts += [Text(said) for said in (unsure_in_words(found), *rivals(found)) if said]
    parts.append(_before_after(found))
    beside = (others_in_words(found), idle_in_words(found), narrowed_in_words(found))
    parts += [Text(said) for said in beside if said]
    if found.completeness:
        parts.append(Text(f"completeness: {completeness_in_words(found)}"))
    parts += [
        Text(
            f"tried {tried_in_words(found)} in {counted(len(found.steps), 'step')}, "
            f"{found.seconds:.0f} s on {counted(said.processes, 'process', 'es')}; {found.stopped}"
        ),
        Text(f"report: {(folder or tree / 'trace') / 'report.html'}"),
        *(Text(f"law:    {file}") for file in sorted((folder or tree / "trace").glob("proposed_law*.py"))),
    ]
    if found.accepted or found.narrowed or found.own_values:
        parts.append(Text(f"go on:  {said.commands[0]}"))
    parts += [Text(f"ask further:  {command}") for command in said.further_traces]
    return [*parts, *_advice_of_the_fit(tree, found)]


def _advice_of_the_fit(tree: Path, found: Trace) -> list[RenderableType]:
    """What the fit says of records and bounds that the trace stands on, and what it advises. The trace
    has horizons of its own, and warns where they are too short. Where it fits every record, none of them
    leaves what was fitted. What a wide smoothing of sign(v) did to the descent is past where it narrowed
    that."""
    if not (tree / ESTIMATE).exists():
        return []
    fits_all = all(record.role == FITTED for record in found.records)
    its_own = {"horizon", *(("range",) if fits_all else ()), *(BLURRED if found.narrowed else ())}
    quality = fit_of(tree).quality
    whose = "the fit of the declared model" if found.accepted else "the fit"
    told = [(f"advice of {whose}", one.said) for one in quality.advice if one.kind not in its_own]
    wrong = [one.said for one in quality.findings if one.kind in WRONG_READING]
    told = [*((f"beware, by {whose}", said) for said in wrong), *told]
    return [Text(f"{who}: {said}", style="cyan") for who, said in told]


def _accepted(found: Trace) -> RenderableType:
    columns = (
        "effect", "port", "estimate ± 95 %", "refitted to the held-out records", "gain", "adjusted p",
        "cannot be told from", "other numerics",
    )  # fmt: skip
    made = table(f"Accepted ({found.provenance})", columns, words=(0, 1, 2, 3, 6))
    for entry in found.accepted:
        survived = [s.survives for s in entry.survivals if s.simulated and not s.refuted]
        refuted = sum(s.refuted for s in entry.survivals)
        made.add_row(
            entry.effect,
            entry.port,
            ", ".join(parameters_in_words(entry.parameters)),
            ", ".join(parameters_in_words(entry.by_held_out)) or NONE,
            share(entry.gain),
            probability(entry.p_value),
            ", ".join(entry.others) or NONE,
            f"{sum(survived)} of {len(survived)} agree"
            + (f"; {counted(refuted, 'other')} cannot fit the records" if refuted else ""),
        )
    return made


def _before_after(found: Trace) -> RenderableType:
    """The error on each record before and after; once, where nothing was added."""
    both = ("RMSE before", "after", "change", "R² before", "after") if found.accepted else ("RMSE", "R²")
    columns = ("record", "output", "view", "network", *both, "data")
    title = "Before and after" if found.accepted else "The model's errors"
    made = table(title, columns, words=(0, 1, 2, 3, len(columns) - 1))
    first, last = found.path[0].held_out_rmse, found.path[-1].held_out_rmse
    for name, floor in found.noise_floor.items():
        where = ("horizons that judge", name, view(found.horizon), NONE)
        errors = [quantity(one[name], floor.unit) for one in (first, last)]
        cells = _cells(found, errors, change(first[name], last[name]), [NONE, NONE])
        made.add_row(*where, *cells, provenance(found.provenance))
    for before, after in zip(found.before, found.after, strict=True):
        network = "with" if before.network else NONE
        where = (f"{before.record} ({before.role})", before.output, view(before.horizon), network)
        errors = [quantity(one.rmse, one.unit) for one in (before, after)]
        r2 = [r_squared(one.r2, UNKNOWN) for one in (before, after)]
        cells = _cells(found, errors, change(before.rmse, after.rmse), r2)
        made.add_row(*where, *cells, provenance(before.provenance))
    return made


def _cells(found: Trace, errors: Sequence[str], change_: str, r2: Sequence[str]) -> tuple[str, ...]:
    """The ``errors`` and ``r2`` before and after with their change, or those of the one model."""
    return (*errors, change_, *r2) if found.accepted else (errors[-1], r2[-1])
