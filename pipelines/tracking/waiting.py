"""Runs that could not be sent, kept in ``<paths.outputs>/mlflow-waiting`` until ``hybridid log`` does."""

from __future__ import annotations

import hashlib
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from filelock import FileLock

from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.remembered import is_remembered, remember
from pipelines.shared.secrets import without_password
from pipelines.shared.storage import read_as, write_json
from pipelines.shared.tree import remove
from pipelines.shared.trust import printable
from pipelines.shared.watch import Watcher
from pipelines.tracking.begun import lift_left
from pipelines.tracking.note import Artifact, Note, raised
from pipelines.tracking.send import send
from pipelines.tracking.store import answers, store_folder, tracking_uri

SILENT = "the server does not answer"
_UNFINISHED = ".unfinished-"
_NOTE = "note.json"
SERVERS = "servers"
"""The kind under which the stores are remembered for which runs were kept."""


@dataclass(frozen=True)
class Attempt:
    """A run that waited: where it was to go, and why it still waits (empty: it is sent)."""

    note: Note
    uri: str
    trouble: str = ""


def folder(settings: Settings) -> Path:
    """Where runs wait."""
    return store_folder(settings) / "mlflow-waiting"


def keep(note: Note, settings: Settings) -> Path:
    """Keep the note with copies of its files; its folder appears whole or not at all."""
    root = folder(settings)
    root.mkdir(parents=True, exist_ok=True)
    new = Path(tempfile.mkdtemp(prefix=_UNFINISHED, dir=root))  # open to the user alone
    if note.uri is not None:
        with suppress(ConfigError):  # then hybridid log asks for the address
            remember(SERVERS, _digest(note.uri), note.uri)
    try:
        copies = tuple(_copied(artifact, new, k) for k, artifact in enumerate(note.artifacts))
        write_json(new / _NOTE, replace(note, artifacts=copies))
        # by time: a run's later note fills it after the earlier; by the random name: none is replaced
        final = root / f"{time.time_ns()}-{new.name.removeprefix(_UNFINISHED)}"
        return new.rename(final)
    finally:
        shutil.rmtree(new, ignore_errors=True)


def _copied(artifact: Artifact, new: Path, number: int) -> Artifact:
    """A copy of it below ``new``; its path in the note is relative, so that the folder may be moved."""
    place = Path("files") / str(number) / artifact.source.name
    (new / place).parent.mkdir(parents=True)
    if artifact.source.is_dir():
        try:
            shutil.copytree(artifact.source, new / place)
        except shutil.Error as error:  # a list of (from, to, why) as long as the folder
            raise OSError(error.args[0][0][2]) from error
    else:
        shutil.copy2(artifact.source, new / place)
    return Artifact(place, artifact.into)


def waiting(settings: Settings) -> list[tuple[Path, Note]]:
    """The notes that wait, the oldest first."""
    found = []
    for place in sorted(folder(settings).glob(f"[0-9]*/{_NOTE}")):
        note = read_as(Note, place)
        here = tuple(Artifact(place.parent / a.source, a.into) for a in note.artifacts)
        uri = None if note.uri is None else without_password(note.uri)
        found.append((place.parent, replace(note, artifacts=here, uri=uri)))
    return found


def send_waiting(settings: Settings, watcher: Watcher) -> Iterator[Attempt]:
    """Send all that waits, each to where it was to go, or all to ``mlflow.tracking_uri`` if that is given.

    What is sent is removed. A server that does not answer is not asked again for the others.
    """
    if not folder(settings).is_dir():
        return
    given = settings.mlflow.tracking_uri
    failed: dict[str, str] = {}
    with FileLock(str(folder(settings) / ".lock")):
        for place, note in waiting(settings):
            watcher.carry_on()
            uri = (None if given else note.uri) or tracking_uri(settings)
            trouble = failed.get(uri, "") or _strange(place, note, uri if uri == note.uri else None)
            trouble = trouble or _trouble(replace(note, uri=uri), settings)
            if not trouble:
                remove(place)
            elif trouble == SILENT:
                failed[uri] = trouble
            yield Attempt(note, uri, trouble)


def _trouble(note: Note, settings: Settings) -> str:
    """Send it. Returns the reason if that failed, else an empty text."""
    try:
        send(note, settings)
    except Exception as error:
        lift_left(note.key, settings)  # it waits on
        return reason(error, note.uri or tracking_uri(settings))
    return ""


def reason(error: Exception, uri: str) -> str:
    """Why a store did not take a run, in one short line."""
    return raised(error, 200) if answers(uri) else SILENT


def _strange(place: Path, note: Note, uri: str | None) -> str:
    """Why a folder of runs may come from somebody else; empty if not. Such a folder must not send files."""
    for artifact in note.artifacts:
        inside = artifact.source.resolve().is_relative_to(place.resolve())
        if not inside or any(path.is_symlink() for path in (artifact.source, *artifact.source.rglob("*"))):
            return f"{printable(artifact.source)} lies outside of {place}"
    if uri is not None and not is_remembered(SERVERS, _digest(uri)):
        return f"you never logged to this store from here; mlflow.tracking_uri={printable(uri)} sends it"
    return ""


def _digest(uri: str) -> str:
    return hashlib.sha256(uri.encode()).hexdigest()
