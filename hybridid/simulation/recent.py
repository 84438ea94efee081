"""``Recent``: the results that were asked for last, up to a number of bytes."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, Protocol, TypeVar


class Sized(Protocol):
    """What tells how many bytes it takes."""

    @property
    def nbytes(self) -> int:
        """Bytes that it takes."""


T = TypeVar("T", bound=Sized)


class Recent(Generic[T]):
    """Results by key; those asked for longest ago go first where all would take more than ``room`` bytes.

    A result is shared by all who ask for it, so nobody may change it.
    """

    def __init__(self, room: int) -> None:
        self._room, self._kept = room, OrderedDict[Hashable, T]()
        self._taken = 0

    def get(self, key: Hashable, make: Callable[[], T]) -> T:
        """The result of ``key``; ``make()`` if it is not at hand."""
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key]
        made = make()
        if made.nbytes <= self._room:
            self._kept[key] = made
            self._taken += made.nbytes
        while self._taken > self._room:
            _, oldest = self._kept.popitem(last=False)
            self._taken -= oldest.nbytes
        return made
