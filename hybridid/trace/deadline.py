"""``Deadline``: from when on a search begins nothing further, and whether that has left something out."""

from __future__ import annotations

import math
import time


class Deadline:
    """The end of a search, so many ``seconds`` from now (None or infinite: it has none).

    ``left_out`` is whether something was not begun because of it. Up to then a search does what one without
    an end does.
    """

    def __init__(self, seconds: float | None = None) -> None:
        self.seconds = math.inf if seconds is None else seconds
        self.left_out = False
        self._until = time.monotonic() + self.seconds

    @property
    def exists(self) -> bool:
        """Whether the search has an end."""
        return math.isfinite(self.seconds)

    def allows(self, seconds: float = 0.0) -> bool:
        """Whether what takes so many ``seconds`` would end in time, and so may begin."""
        in_time = time.monotonic() + seconds < self._until
        self.left_out |= not in_time
        return in_time
