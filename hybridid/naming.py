"""Names in a sentence, and how a wrong name is answered: with the nearest right one and what is allowed."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence

LONGEST_NAME = 100
"""Bytes of a name after which files are named."""
MOST_LISTED = 400
"""Characters of names that a message lists; of more it lists the first ones and how many there are."""


def listed(names: Sequence[str]) -> str:
    """``a, b and c``; ``nothing`` where there is none."""
    if not names:
        return "nothing"
    return " and ".join(part for part in (", ".join(names[:-1]), names[-1]) if part)


def counted(number: int, what: str, ending: str = "s") -> str:
    """``1 step``, ``2 steps``: a count, and ``what`` with the ``ending`` of its plural."""
    return f"{number} {what}" + ("" if number == 1 else ending)


def as_entry(name: str) -> str:
    """``viscous@carriage``, as ``effects=[...]`` of a config takes it, for the name ``carriage.viscous``."""
    return "@".join(reversed(name.rsplit(".", 1)))


def unknown(what: str, name: object, known: Iterable[str], allowed: Iterable[str] | None = None) -> str:
    """``unknown <what> '<name>': did you mean '<nearest>'? allowed: ...``

    ``allowed`` are the names to print where ``known``, which are compared, would be too many.
    """
    names = list(known)
    printed = names if allowed is None else list(allowed)
    return f"unknown {what} {shortened(str(name), 80)!r}: {nearest(name, names)}allowed: {_few(printed)}"


def _few(names: Sequence[str]) -> str:
    """All of a few names, or of many the first ones and how many there are."""
    every = ", ".join(names) or "none"
    if len(every) <= MOST_LISTED:
        return every
    return f"{every[:MOST_LISTED].rpartition(',')[0]}, ... ({len(names)} in all)"


def nearest(name: object, known: Iterable[str]) -> str:
    """``did you mean '<nearest>'? ``, or nothing if none of ``known`` is near."""
    by_lower = {n.lower(): n for n in reversed(list(known))}
    near = difflib.get_close_matches(str(name).lower(), by_lower, n=1, cutoff=0.5)
    return f"did you mean {by_lower[near[0]]!r}? " if near else ""


def no_file_name(name: str) -> str:
    """Why files cannot be named after ``name``; empty if they can."""
    if not name or name.startswith(".") or set(name) & set("/\\") or not name.isprintable():
        return "its files are named after it, so give a name without /, \\ and a dot at its beginning"
    if len(name.encode()) > LONGEST_NAME:
        return f"its files are named after it, so give a name of at most {LONGEST_NAME} bytes"
    return ""


def shortened(text: str, most: int = 300) -> str:
    """``text`` on one line, its middle left out beyond ``most`` characters."""
    line = " ".join(text.split())
    return line if len(line) <= most else f"{line[: most * 2 // 3]} ... {line[-most // 4 :]}"
