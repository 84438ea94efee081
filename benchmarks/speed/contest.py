"""Ways to one result, timed in turn: each in a process of its own, so that its peak memory is known.

All ways of a contest are called once before anything is timed: what is compiled once is nobody's time. Then
they take turns, so that what else the machine does meets all alike.
"""

from __future__ import annotations

import multiprocessing
import os
import resource
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from statistics import median
from typing import Any


@dataclass(frozen=True)
class Way:
    """A way to the result: ``run()`` gives what it found. ``slow``: timed once, without a call before."""

    name: str
    run: Callable[[], Any]
    slow: bool = False


@dataclass(frozen=True)
class Timed:
    """The wall seconds of each call, the peak memory [MB] of the process, and what it found last."""

    name: str
    seconds: tuple[float, ...]
    memory: float
    found: Any

    @property
    def median(self) -> float:
        """Of the seconds."""
        return median(self.seconds)


def contest(ways: Sequence[Way], repeats: int, say: Callable[[str], None]) -> list[Timed]:
    """Call every way ``repeats`` times, one after the other, round after round.

    Raises:
        RuntimeError: if a way fails.
    """
    players = [_Player(way) for way in ways]
    try:
        for player in players:
            if not player.way.slow:
                player.call()
        for turn in range(repeats):
            for player in players:
                if turn == 0 or not player.way.slow:
                    player.seconds.append(player.call())
        for player in players:
            say(f"  {player.way.name}: {median(player.seconds):.4g} s")
        return [player.timed() for player in players]
    finally:
        for player in players:
            player.end()


class _Player:
    """A process that calls its way when it is asked to."""

    def __init__(self, way: Way) -> None:
        self.way = way
        self.seconds: list[float] = []
        self._found: Any = None
        self._memory = 0.0
        context = multiprocessing.get_context("fork")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, way.run))
        self._process.start()
        theirs.close()

    def call(self) -> float:
        self._pipe.send(True)
        try:
            seconds, self._memory, self._found = self._pipe.recv()
        except EOFError:
            raise RuntimeError(f"{self.way.name}: its process ended") from None
        if isinstance(self._found, Exception):
            raise RuntimeError(f"{self.way.name}: {self._found}") from self._found
        return float(seconds)

    def timed(self) -> Timed:
        return Timed(self.way.name, tuple(self.seconds), self._memory, self._found)

    def end(self) -> None:
        with suppress(OSError):  # it may have ended
            self._pipe.send(False)
        self._pipe.close()
        self._process.join()


def _serve(pipe: Connection, run: Callable[[], Any]) -> None:
    for name in ("OMP", "MKL", "OPENBLAS"):
        os.environ[f"{name}_NUM_THREADS"] = "1"
    while pipe.recv():
        began = time.perf_counter()
        try:
            found = run()
        except Exception as error:
            found = error
        seconds = time.perf_counter() - began
        pipe.send((seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, found))
