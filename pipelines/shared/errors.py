"""What a user asked for and cannot have, said in one line. Imports nothing heavy."""

from __future__ import annotations

from hybridid.naming import unknown

__all__ = ["ConfigError", "Incomplete", "unknown"]


class ConfigError(ValueError):
    """A wrong request: the message names it, where it stands and what is allowed."""


class Incomplete(RuntimeError):
    """Part of what was asked for failed, the rest is there: the message names both."""
