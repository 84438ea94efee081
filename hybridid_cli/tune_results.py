"""The results of a search as text for the terminal: the best trials, the chosen one and why."""

from __future__ import annotations

from rich.console import RenderableType
from rich.text import Text

from hybridid_cli.tables import rendered, table
from pipelines.tune.conduct import TuneOutcome
from pipelines.tune.findings import RULE, said
from pipelines.tune.report import cells, columns, command

_MOST = 10


def tune_results(tuned: TuneOutcome) -> str:
    """The table, the choice with its rule, and how to take it up."""
    findings = tuned.findings
    counts = ", ".join(
        f"{len(rows)} {name}"
        for name, rows in (
            ("to their end", findings.of("done")),
            ("pruned", findings.of("pruned")),
            ("failed", findings.of("failed")),
            ("stopped from outside", findings.of("stopped")),
            ("still running elsewhere", findings.of("running")),
        )
        if rows
    )
    parts: list[RenderableType] = [_table(tuned), Text(f"trials: {counts or 'none'}; {tuned.seconds:.0f} s")]
    missing = tuned.request.trials - len(findings.of("done", "pruned", "failed"))
    if missing > 0:
        parts.append(
            Text(f"{missing} of {tuned.request.trials} trials are not done: the same command continues")
        )
    chosen = findings.chosen
    if chosen is not None:
        parts += [
            Text(f"chosen: trial {chosen.number}, {said(chosen.values)}", style="bold"),
            Text(f"  {chosen.outcome} ({tuned.provenance} data)"),
            Text(f"  by {RULE}"),
            Text(f"  {command(tuned.folder)}"),
        ]
    return rendered([*parts, Text(f"page: {tuned.folder / 'index.html'}")])


def shortfall(tuned: TuneOutcome) -> str:
    """What is missing, in one line; empty if nothing is."""
    failed, findings = tuned.findings.of("failed"), tuned.findings
    if failed:
        first = failed[0]
        return (
            f"{len(failed)} of {len(findings.rows)} trials failed; the first is trial {first.number} "
            f"({said(first.values)}): {first.remark}"
        )
    if tuned.lost:
        return f"{'; '.join(tuned.lost)}; the same command continues"
    return "" if findings.chosen else "no trial has finished; the same command continues"


def _table(tuned: TuneOutcome) -> RenderableType:
    keys, outputs = columns(tuned.findings)
    values = (key.replace("orders.", "") for key in keys)
    header = ("trial", "share", "weights", *values, *(f"RMSE of {name}" for name in outputs), "s")
    made = table(f"Best trials on the held-out blocks ({tuned.provenance})", header, words=())
    for row in tuned.findings.best[:_MOST]:
        made.add_row(*cells(row, keys, outputs))
    return made
