"""Errors of a user's request, each with a message of one line. Imports no slow module."""

from __future__ import annotations

from hybridid.naming import unknown

__all__ = ["ConfigError", "Incomplete", "NotConverged", "WrongModel", "unknown"]


class ConfigError(ValueError):
    """A wrong request: the message says what is wrong, where, and what is allowed."""


class Incomplete(RuntimeError):
    """Part of a request failed; the message names what failed and what is there."""


class NotConverged(RuntimeError):
    """All results are written, but the fit has not converged."""


class WrongModel(RuntimeError):
    """All results are written, but the fitted model is wrong: worse than doing nothing, or with a wrong
    sign, unit or column."""
