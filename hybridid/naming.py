"""Names in a sentence, and how a wrong name is answered: with the nearest right one and what is allowed."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence


def listed(names: Sequence[str]) -> str:
    """``a, b and c``; ``nothing`` where there is none."""
    if not names:
        return "nothing"
    return " and ".join(part for part in (", ".join(names[:-1]), names[-1]) if part)


def unknown(what: str, name: object, known: Iterable[str], allowed: Iterable[str] | None = None) -> str:
    """``unknown <what> '<name>': did you mean '<nearest>'? allowed: ...``

    ``allowed`` are the names to print where ``known``, which are compared, would be too many.
    """
    names = list(known)
    by_lower = {n.lower(): n for n in reversed(names)}
    near = difflib.get_close_matches(str(name).lower(), by_lower, n=1, cutoff=0.5)
    hint = f"did you mean {by_lower[near[0]]!r}? " if near else ""
    printed = names if allowed is None else list(allowed)
    return f"unknown {what} {str(name)!r}: {hint}allowed: {', '.join(printed) or 'none'}"
