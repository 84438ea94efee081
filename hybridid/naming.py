"""How a wrong name is answered: one line with the nearest right one and what is allowed."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def unknown(what: str, name: object, known: Iterable[str], allowed: Iterable[str] | None = None) -> str:
    """``unknown <what> '<name>': did you mean '<nearest>'? allowed: ...``

    ``allowed`` are the names to print where ``known``, which are compared, would be too many.
    """
    names = list(known)
    by_lower = {n.lower(): n for n in reversed(names)}
    near = difflib.get_close_matches(str(name).lower(), by_lower, n=1, cutoff=0.5)
    hint = f"did you mean {by_lower[near[0]]!r}? " if near else ""
    listed = names if allowed is None else list(allowed)
    return f"unknown {what} {str(name)!r}: {hint}allowed: {', '.join(listed) or 'none'}"
