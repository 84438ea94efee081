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
    printed = names if allowed is None else list(allowed)
    return f"unknown {what} {str(name)!r}: {nearest(name, names)}allowed: {', '.join(printed) or 'none'}"


def nearest(name: object, known: Iterable[str]) -> str:
    """``did you mean '<nearest>'? ``, or nothing if none of ``known`` is near."""
    by_lower = {n.lower(): n for n in reversed(list(known))}
    near = difflib.get_close_matches(str(name).lower(), by_lower, n=1, cutoff=0.5)
    return f"did you mean {by_lower[near[0]]!r}? " if near else ""
