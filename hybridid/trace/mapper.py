"""How a trace's refits are run (one after another, or side by side) and how their progress is reported."""

from __future__ import annotations

from collections.abc import Callable, Iterable

Mapper = Callable[[Callable[..., object], Iterable[tuple]], Iterable]
"""``mapper(function, argument tuples)``: results in order; a process pool, or plain ``map``."""
Report = Callable[[str, int, int, str], None]
"""``report(stage, done, of, what)``: the stage's name, how many results of how many, and the last one; empty
where there is none yet, or it has no name."""


def serial(function: Callable[..., object], arguments: Iterable[tuple]) -> Iterable:
    """The plain mapper: one after another, in this process."""
    return (function(*given) for given in arguments)


def silent(stage: str, done: int, of: int, what: str) -> None:
    """A report that does nothing."""


def unheard(line: str) -> None:
    """Told something, it does nothing."""
