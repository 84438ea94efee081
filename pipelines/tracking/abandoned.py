"""Ends what was left ``RUNNING``: a run of this machine whose process was killed, or found its disk full."""

from __future__ import annotations

from pipelines.shared.config import Settings
from pipelines.tracking.begun import Begun, left
from pipelines.tracking.send import end
from pipelines.tracking.store import tracking_uri
from pipelines.tracking.waiting import keep, reason, waiting

REASON = "its command ended before the run was logged"


def end_abandoned(settings: Settings) -> str:
    """End all of them in the store of ``settings``; why that failed, if so. The next command tries again."""
    try:
        for begun in left(settings):
            _end(begun, settings)
    except Exception as error:
        return reason(error, tracking_uri(settings))
    return ""


def _end(begun: Begun, settings: Settings) -> None:
    """Also a run that still waits to be sent: its end waits after it."""
    notes = [note for _, note in waiting(settings) if note.key == begun.key]
    if notes and notes[-1].ended is None:
        keep(notes[-1].closed("KILLED", REASON), settings)
    end(begun.key, begun.experiment, settings, "KILLED", REASON)
