"""Inputs that Hypothesis draws, and shrinks to the smallest that breaks."""

from __future__ import annotations

import multiprocessing
import multiprocessing.connection
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import seed as seeded
from hypothesis.strategies import SearchStrategy

from benchmarks.torture.bench import HANGS, UNCLEAR, WRONG, Fault, Found, Part
from benchmarks.torture.drawn_configs import (
    model_file_is_read_or_refused,
    model_files,
    setting_is_of_its_type,
    settings_given,
)
from benchmarks.torture.drawn_recordings import bytes_are_read_or_refused, contents, table_comes_back, tables

PROPERTIES: Mapping[str, tuple[Callable[[], SearchStrategy[Any]], Callable[[Any], None]]] = {
    "a table as CSV": (tables, table_comes_back),
    "the bytes of a recording": (contents, bytes_are_read_or_refused),
    "a value of a key": (settings_given, setting_is_of_its_type),
    "a changed model.json": (model_files, model_file_is_read_or_refused),
}
"""What is drawn, and what must hold for it."""
EXAMPLES, RUNS = 400, 4
"""Inputs that a trial draws, and trials of each property."""
SECONDS = 600.0


@dataclass(frozen=True)
class Property:
    """A property, held against inputs that are drawn from a seed."""

    name: str
    number: int
    seed: int

    @property
    def key(self) -> str:
        return f"properties: {self.name}, seed {self.seed}.{self.number}"

    @property
    def category(self) -> str:
        return self.name

    def carried_out(self, bench: Path) -> Found:
        """Draw the inputs in a process of their own: some libraries crash on what is broken."""
        fork = multiprocessing.get_context("fork")
        ours, theirs = fork.Pipe(duplex=False)
        process = fork.Process(target=_told, args=(self, theirs))
        process.start()
        theirs.close()
        process.join(SECONDS)
        if process.exitcode is None:
            process.kill()
            process.join()
            return Found("", (Fault(HANGS, f"still runs after {SECONDS:g} s"),))
        kind, what = ours.recv() if process.exitcode == 0 else (WRONG, f"exit code {process.exitcode}")
        faults = (Fault(kind, what),) if what else ()
        return Found(f"{EXAMPLES} inputs", faults, {"inputs drawn": float(EXAMPLES)})


def check(name: str, examples: int, seed: int | None = None) -> None:
    """Hold a property against so many inputs, the same each time if there is no seed.

    Raises:
        AssertionError: for the smallest input that breaks it; so does whatever else was raised.
    """
    drawn, holds = PROPERTIES[name]
    run = _run(drawn(), holds, examples, seed)
    run()


def trials(seed: int) -> list[Property]:
    """Some of each property."""
    return [Property(name, number, seed) for name in PROPERTIES for number in range(RUNS)]


PART = Part(
    "properties",
    "Hypothesis draws tables in every dialect of CSV, the bytes of recordings, values of every key, and "
    "changes of a model file. A table comes back as it was written, a value has its declared type, a model "
    "file gives a model. Or the input is refused in one line.",
    (WRONG, UNCLEAR, HANGS),
    trials,
)


def _run(
    strategy: SearchStrategy[Any], holds: Callable[[Any], None], examples: int, seed: int | None
) -> Callable[[], None]:
    own = settings(
        max_examples=examples,
        database=None,
        deadline=None,
        derandomize=seed is None,
        suppress_health_check=list(HealthCheck),
    )
    run: Callable[[], None] = own(given(strategy)(holds))
    return run if seed is None else seeded(seed)(run)


def _told(one: Property, pipe: multiprocessing.connection.Connection) -> None:
    """Send what is wrong; empty if nothing is."""
    try:
        check(one.name, EXAMPLES, seed=one.seed * RUNS + one.number)
    except Exception as broken:
        kind = WRONG if isinstance(broken, AssertionError) else UNCLEAR
        notes = " ".join(getattr(broken, "__notes__", ()))
        pipe.send((kind, " ".join(f"{type(broken).__name__}: {broken} {notes}".split())[:1000]))
    else:
        pipe.send((WRONG, ""))
