"""Errors of a user's request, each with a message of one line. Imports no slow module."""

from __future__ import annotations

from hybridid.naming import unknown

__all__ = ["ConfigError", "Incomplete", "LostJob", "NotConverged", "WrongModel", "unknown"]


class ConfigError(ValueError):
    """A wrong request: the message says what is wrong, where, and what is allowed."""


class Incomplete(RuntimeError):
    """Part of a request failed; the message names what failed and what is there."""


class LostJob(Incomplete):
    """A job of a launcher ended without a result.

    ``by_chance``: its process was killed or its node was lost, and the same job may succeed elsewhere. A job
    that its user cancelled, or that took too much memory or time, was not lost by chance.
    """

    def __init__(self, message: str, by_chance: bool = False) -> None:
        super().__init__(message)
        self.by_chance = by_chance


class NotConverged(RuntimeError):
    """All results are written, but the fit has not converged."""


class WrongModel(RuntimeError):
    """All results are written, but the fitted model is wrong: worse than doing nothing, or with a wrong
    sign, unit or column."""
