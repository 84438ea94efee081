"""Imports MLflow in parallel with a command. The import takes seconds, which is longer than a fit.

The process that workers are forked from imports MLflow while the command works. One of its workers then sends
the run, and the command waits for it. The worker ends when the command ends.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from pipelines.shared.config import Settings
from pipelines.shared.pool import Lost, load_early, side_by_side
from pipelines.shared.watch import Watcher
from pipelines.tracking.note import Note
from pipelines.tracking.send import send
from pipelines.tracking.store import is_remote, set_environment, tracking_uri
from pipelines.tracking.waiting import reason

_MODULES = ("pipelines.tracking.ahead", "mlflow.tracking", "mlflow.store.tracking.sqlalchemy_store")
_begun = False


@contextmanager
def imported_beside() -> Iterator[None]:
    """Begin to import MLflow if there is a second core.

    A worker then sends the runs that are logged inside the context.
    """
    global _begun
    if (os.cpu_count() or 1) > 1:
        set_environment()
        load_early(*_MODULES)
        _begun = True
    try:
        yield
    finally:
        _begun = False


def sends(settings: Settings) -> bool:
    """Whether a worker sends the run: only to the file of this machine. The wait for a server has a time
    limit of its own."""
    return _begun and not is_remote(tracking_uri(settings))


def sent_beside(note: Note, settings: Settings) -> str:
    """Send the note as ``send`` does. Returns the reason if that failed, else an empty text."""
    ((_, said),) = side_by_side(_sent, {note.name: (note, settings)}, 1)
    return said.reason if isinstance(said, Lost) else str(said)


def _sent(given: tuple[Note, Settings], watcher: Watcher) -> str:
    note, settings = given
    try:
        send(note, settings)
    except Exception as error:  # it may not be fit to be pickled
        return reason(error, tracking_uri(settings))
    return ""
