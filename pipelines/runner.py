"""Runs the stages of a command whose results are missing or stale."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import yaml

from hybridid.naming import counted
from pipelines.fit import FIT
from pipelines.plot.stage import PLOT
from pipelines.preprocess import PREPROCESS
from pipelines.residual.stage import RESIDUAL
from pipelines.shared.config import Settings, digest_of
from pipelines.shared.errors import ConfigError
from pipelines.shared.freshness import (
    Fingerprint,
    fingerprint,
    folder_digest,
    why_stale,
    write_receipt,
)
from pipelines.shared.secrets import masked_below
from pipelines.shared.side_by_side import (
    in_words,
    remove_results,
    results_folder,
    show_newest,
    take_in,
    with_other_options,
)
from pipelines.shared.sources import sources_of
from pipelines.shared.stage import Job, Outcome, Stage
from pipelines.shared.tree import locked, point_latest, replacing, tree_of, write_text
from pipelines.shared.watch import Watcher
from pipelines.trace.stage import TRACE
from pipelines.validate import VALIDATE

RUN: tuple[Stage, ...] = (PREPROCESS, FIT, RESIDUAL, VALIDATE, PLOT)
"""The stages of the command ``run``, in order."""
STAGES: tuple[Stage, ...] = (*RUN, TRACE)


def run_stages(
    settings: Settings,
    command: str,
    watcher: Watcher,
    first: Callable[[Path], None] = lambda root: None,
    instead: Mapping[str, Callable[[Job], None]] = MappingProxyType({}),
) -> Outcome:
    """Bring the stages of ``command`` (a stage's name, or ``run`` for all) up to date.

    ``first`` is called with the run tree before the stages run. ``instead`` replaces the function that runs a
    stage, by the stage's name: for callers that have computed its result already.

    Raises:
        ConfigError: before anything is written, if the request cannot be carried out.
        RecordError: if a record cannot be used.
    """
    stages = check_stages(settings, command)
    stages = tuple(replace(s, run=instead.get(s.name, s.run)) for s in stages)
    sources = sources_of(settings)
    root = tree_of(settings, sources.simulated)
    if root.exists() and not root.is_dir():
        raise ConfigError(f"out is {root}: this is a file; give a folder")
    for remark in sources.remarks:
        watcher.warn(remark)
    with locked(root, watcher.say):
        first(root)
        write_text(
            root / "config.yaml",
            yaml.safe_dump(masked_below(settings.config), sort_keys=False, allow_unicode=True),
            mode=0o600,
        )
        for stage in STAGES:
            take_in(stage, root)
            if not stage.asked(settings) and remove_results(stage, root):
                watcher.say(f"{stage.name}: removed, the config no longer asks for it")
        ran = _bring_up_to_date(stages, settings, root, watcher)
        if settings.get("out") is None:
            point_latest(root)
    folders = {stage.name: results_folder(stage, settings, root) for stage in stages}
    return Outcome(root, tuple(folders), tuple(ran), folders)


def check_stages(settings: Settings, command: str) -> tuple[Stage, ...]:
    """The stages that ``command`` runs with this config.

    Raises:
        ConfigError: if one of them cannot be carried out.
    """
    stages = tuple(s for s in wanted(command) if s.name == command or s.asked(settings))
    for stage in stages:
        stage.check(settings)  # reports a wrong name now, not after minutes
    return stages


def is_fresh(settings: Settings, command: str, root: Path) -> bool:
    """Whether all results of ``command`` are in the tree ``root`` and none is stale."""
    stages = (s for s in wanted(command) if s.name == command or s.asked(settings))
    return all(
        not why_stale(results_folder(stage, settings, root), _made_from(stage, settings, root))
        for stage in stages
    )


def wanted(command: str) -> tuple[Stage, ...]:
    """The stage called ``command`` after the stages whose results it needs; ``RUN`` for ``run``."""
    if command == "run":
        return RUN
    names = {command}
    for stage in reversed(STAGES):
        if stage.name in names:
            names.update(stage.reads)
    return tuple(stage for stage in STAGES if stage.name in names)


def _bring_up_to_date(
    stages: tuple[Stage, ...], settings: Settings, root: Path, watcher: Watcher
) -> list[str]:
    """Run the stages whose results are missing or stale, report why, and return their names."""
    ran: list[str] = []
    outdated: dict[str, int] = {}
    checked = False
    for stage in stages:
        if stage.name != PREPROCESS.name and not checked:
            for one in stages:
                one.check_records(settings, root)  # reports what no fit would mend, before the fit
            checked = True
        now, folder = _made_from(stage, settings, root), results_folder(stage, settings, root)
        reasons = why_stale(folder, now)
        if stage.name in outdated:
            reasons = [f"the result of {name} changed" for name in stage.reads if name in ran]
        if not reasons and not settings.lone.force:
            watcher.say(f"{stage.name}: fresh, reused")
        else:
            watcher.say(f"{stage.name}: {_because(reasons)}")
            if _changed_by(stage, now, settings, root, watcher):
                outdated |= _remove_readers(stage.name, root)
            ran.append(stage.name)
        show_newest(stage, folder, root)
        if others := with_other_options(stage, folder, now):
            watcher.say(f"{stage.name}: {in_words(others)}")
    for stage in STAGES:
        if why := _removed(stage, outdated.get(stage.name, 0), stage.name in ran):
            watcher.say(f"{stage.name}: {why}")
    return ran


def _removed(stage: Stage, results: int, made_again: bool) -> str:
    """In words, that so many ``results`` were removed; empty if there is nothing to say."""
    because = "made from results that have changed"
    if results and not made_again:
        return f"removed, it was {because}; hybridid {stage.name} makes it anew"
    if results and stage.side_by_side:
        return f"{counted(results, 'earlier result')} removed, {because}"
    return ""


def _changed_by(
    stage: Stage, made_from: Fingerprint, settings: Settings, root: Path, watcher: Watcher
) -> bool:
    """Run ``stage`` and return whether its results differ from the earlier ones."""
    folder = results_folder(stage, settings, root)
    before = folder_digest(folder)
    began = time.perf_counter()
    with replacing(folder, root) as new:
        stage.run(Job(settings, root, new, folder, watcher, _key(stage, made_from, root)))
        watcher.carry_on()  # on Ctrl-C IPOPT returns as if it had ended early
        write_receipt(new, stage.name, made_from, time.perf_counter() - began)
    return folder_digest(folder) != before


def _key(stage: Stage, made_from: Fingerprint, root: Path) -> str:
    """The digest of the run tree, of the code and of the files that the stage reads."""
    return digest_of([str(root.resolve()), stage.name, made_from["inputs"], made_from["code"]])


def _made_from(stage: Stage, settings: Settings, root: Path) -> Fingerprint:
    inputs = {f"the result of {name}": folder_digest(root / name) for name in stage.reads}
    inputs |= stage.inputs(settings)
    return fingerprint(stage.options(settings), inputs, f"pipelines.{stage.name}")


def _because(reasons: list[str]) -> str:
    if not reasons:
        return "fresh, made again (force)"
    if reasons == ["not made yet"]:
        return "not made yet"
    more = f" and {len(reasons) - 2} more" if len(reasons) > 2 else ""
    return f"stale, {'; '.join(reasons[:2])}{more}"


def _remove_readers(name: str, root: Path) -> dict[str, int]:
    """Remove the results that were made from those of ``name``: they would contradict the new ones. How many
    of each stage there were, by its name."""
    gone = {name}
    removed = {}
    for stage in STAGES:
        if gone & set(stage.reads):
            gone.add(stage.name)
            if results := remove_results(stage, root):
                removed[stage.name] = results
    return removed
