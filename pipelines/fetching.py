"""``fetch``: downloads the public records of a case into the first data root."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from hybridid.fetch import archive_named, fetch
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.sections.stages import ArchiveSection
from pipelines.shared.sources import roots_of
from pipelines.shared.watch import Watcher


def fetch_case(settings: Settings, watcher: Watcher) -> list[Path]:
    """Download the case's archive unless it is there already; returns the paths of its files.

    Raises:
        ConfigError: if the case has no public archive.
        FetchError: if the download fails; the message gives the page to visit.
    """
    section = settings.section("archive", ArchiveSection)
    if section.name is None:
        raise ConfigError(f"case {settings.case} has no public archive to fetch")
    archive = archive_named(section.name)
    if section.url:
        archive = replace(archive, url=section.url)
    root = roots_of(settings.paths.data, settings.folders)[0]
    watcher.say(f"{archive.name}: to {root.path / archive.name}; licence: {archive.licence}")
    watcher.say(f"please cite: {archive.citation}")
    return fetch(archive, root.path, lambda done, total: _report(watcher, archive.name, done, total))


def _report(watcher: Watcher, name: str, done: int, total: int | None) -> None:
    in_all = f" of {total / 1e6:.2f}" if total else ""
    watcher.progress(f"fetch {name}", f"{done / 1e6:.2f}{in_all} MB", done / total if total else None)
