"""The report of a search: a page, a table as data, and the chosen config, as files beside the journal."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from hybridid.plotting.search_history import Tried, history_plot
from hybridid.plotting.style import save
from hybridid.quantities import fixed, number, percent, quantity
from pipelines.shared.config import MODELLING, Settings
from pipelines.shared.page import Page, Picture, Section, Table
from pipelines.shared.storage import json_text
from pipelines.shared.tree import write_text
from pipelines.tune.findings import RULE, Findings, Row, Search, setting
from pipelines.tune.request import Value, with_values
from pipelines.tune.trial import OBJECTIVE

EXPERIMENT = "tuned"
_MOST = 15
_KEPT = (*MODELLING, "validate")


def written(findings: Findings, settings: Settings, folder: Path, provenance: str) -> list[Path]:
    """Write the report; its files."""
    (folder / "experiment").mkdir(exist_ok=True)
    files = {"tune.json": json_text(_search(findings, settings, provenance))}
    pictures = []
    if findings.of("done", "pruned"):
        plot = history_plot(list(_tried(findings)), f"{settings.case}, held-out share by trial", provenance)
        svg, _ = save(plot, folder, "history", ("svg", "png"))
        pictures.append(Picture(svg, plot.caption))
    if findings.chosen is not None:
        files[f"experiment/{EXPERIMENT}.yaml"] = experiment(settings, findings.chosen, provenance)
    for name, text in files.items():
        write_text(folder / name, text)
    page = page_of(findings, settings, folder, provenance, pictures).write(folder)
    return [*(folder / name for name in files), page, page.with_suffix(".md"), *(p.path for p in pictures)]


def command(folder: Path) -> str:
    """The command that runs the chosen config."""
    return f"hybridid run --config-dir {folder} experiment={EXPERIMENT}"


def experiment(settings: Settings, chosen: Row, provenance: str) -> str:
    """The whole modelling config with the chosen values, as a file of the group ``experiment``."""
    config = with_values(settings, chosen.values).config
    kept = {key: config[key] for key in _KEPT if config.get(key) is not None}
    head = (
        "# @package _global_\n"
        f"# Chosen by hybridid tune: trial {chosen.number}, held-out share {chosen.share:.4g} with "
        f"{chosen.weights} weights ({provenance} data).\n# By {RULE}.\n"
    )
    defaults: list[Any] = [{"override /case": settings.case}, {"override /residual": "narx"}]
    body: dict[str, Any] = {"defaults": defaults, **kept}
    return head + yaml.safe_dump(body, sort_keys=False, allow_unicode=True)


def page_of(
    findings: Findings, settings: Settings, folder: Path, provenance: str, pictures: list[Picture]
) -> Page:
    """The page of the search."""
    chosen = findings.chosen
    lead = "No trial has finished."
    commands: tuple[str, ...] = ()
    if chosen is not None:
        values = ", ".join(f"{key} {setting(value)}" for key, value in _short(chosen).items())
        lead = (
            f"Chosen: trial {chosen.number} with {values}. Of the {provenance} error on the held-out blocks "
            f"{percent(chosen.share, 1)} is left, by {chosen.weights} weights."
        )
        commands = (command(folder),)
    sections = [
        Section(
            "Trials", (f"Objective: {OBJECTIVE}.", f"Choice: {RULE}."), (_trials(findings),), (), commands
        ),
        Section("Course", pictures=tuple(pictures)),
    ]
    if findings.importance:
        sections.append(Section("What mattered", tables=(_importance(findings),)))
    if findings.of("failed"):
        sections.append(Section("Failed", tables=(_failed(findings),)))
    return Page(f"Tuning {settings.case}", lead, tuple(sections), (provenance,))


def columns(findings: Findings) -> tuple[list[str], list[str]]:
    """The keys that were varied, and the outputs."""
    keys = list(dict.fromkeys(key for row in findings.rows for key in _short(row)))
    return keys, list(dict.fromkeys(name for row in findings.rows for name in row.outputs))


def cells(row: Row, keys: list[str], outputs: list[str]) -> list[str]:
    """A finished trial as text: number, share, weights, values, RMSE by output, seconds."""
    found = [row.outputs.get(name) for name in outputs]
    errors = [quantity(one.held_out, one.unit) if one else "" for one in found]
    values = [setting(_short(row)[key]) if key in _short(row) else "" for key in keys]
    share, seconds = number(row.share), fixed(row.seconds, 1)
    return [str(row.number), share, str(row.weights), *values, *errors, seconds]


def _trials(findings: Findings) -> Table:
    keys, outputs = columns(findings)
    best = findings.best[:_MOST]
    shown = best if findings.chosen is None or findings.chosen in best else [*best, findings.chosen]
    rows = []
    for row in shown:
        mark = "chosen " if row is findings.chosen else ""
        first, *rest = cells(row, keys, outputs)
        rows.append((f"{mark}{first}", *rest))
    done, pruned, failed, stopped = (len(findings.of(s)) for s in ("done", "pruned", "failed", "stopped"))
    note = (
        f"{done} trials finished, {pruned} were pruned, {failed} failed, {stopped} were stopped "
        "from outside and do not count"
    )
    header = ("trial", "held-out share", "weights", *keys, *(f"RMSE of {o}" for o in outputs), "s")
    return Table(f"The best {len(best)} of {done}", header, tuple(rows), (note,))


def _importance(findings: Findings) -> Table:
    rows = tuple(
        (key.removeprefix("residual."), percent(share, 0)) for key, share in findings.importance.items()
    )
    note = "share of the difference between better trials and the rest (PED-ANOVA); rough if trials are few"
    return Table("Importance of each key", ("key", "importance"), rows, (note,))


def _failed(findings: Findings) -> Table:
    rows = tuple(
        (str(row.number), " ".join(f"{k}={setting(v)}" for k, v in _short(row).items()), row.remark)
        for row in findings.of("failed")
    )
    return Table("Trials that failed", ("trial", "values", "why"), rows, words=(0, 1, 2))


def _short(row: Row) -> dict[str, Value]:
    return {key.removeprefix("residual."): value for key, value in row.values.items()}


def _tried(findings: Findings) -> Iterator[Tried]:
    for row in findings.of("done", "pruned"):
        share = row.share if row.share is not None else row.last and row.last[1]
        if share is not None:
            yield Tried(row.number, share, row.state == "pruned", row is findings.chosen)


def _search(findings: Findings, settings: Settings, provenance: str) -> Search:
    chosen = None if findings.chosen is None else findings.chosen.number
    return Search(
        settings.case, provenance, OBJECTIVE, RULE, chosen, dict(findings.importance), findings.rows
    )
