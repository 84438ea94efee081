"""What a user asked for and cannot have, said in one line. Imports nothing heavy."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class ConfigError(ValueError):
    """A wrong request: the message names it, where it stands and what is allowed."""


def unknown(what: str, name: str, known: Iterable[str], allowed: Iterable[str] | None = None) -> str:
    """``unknown <what> '<name>': did you mean '<nearest>'? known: ...``

    ``allowed`` are the names to print where ``known``, which are compared, would be too many.
    """
    names = sorted(known)
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    hint = f"did you mean {near[0]!r}? " if near else ""
    listed = names if allowed is None else sorted(allowed)
    return f"unknown {what} {name!r}: {hint}known: {', '.join(listed) or 'none'}"
