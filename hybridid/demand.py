"""``Demand``: the memory and the time that a computation needs, estimated from its sizes before it begins."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Demand:
    """What ``what`` needs: ``memory`` [bytes] at its peak, and ``seconds`` at least, on one core.

    ``keys`` are the settings, with their values, that make it large.
    """

    what: str
    memory: float
    seconds: float
    keys: tuple[str, ...]
