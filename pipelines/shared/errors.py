"""Errors of a user's request, each with a message of one line. Imports no slow module."""

from __future__ import annotations

from hybridid.naming import unknown

__all__ = ["ConfigError", "Incomplete", "unknown"]


class ConfigError(ValueError):
    """A wrong request: the message says what is wrong, where, and what is allowed."""


class Incomplete(RuntimeError):
    """Part of a request failed; the message names what failed and what is there."""
