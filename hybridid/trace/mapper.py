"""``Mapper``: how a trace's refits are run, one after another or side by side."""

from __future__ import annotations

from collections.abc import Callable, Iterable

Mapper = Callable[[Callable[..., object], Iterable[tuple]], Iterable]
"""``mapper(function, argument tuples)``: results in order; a process pool, or plain ``map``."""


def serial(function: Callable[..., object], arguments: Iterable[tuple]) -> Iterable:
    """The plain mapper."""
    return (function(*given) for given in arguments)
