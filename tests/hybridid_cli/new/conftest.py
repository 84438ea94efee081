"""The simulated recordings of ``benchmarks.strangers``, short, as files of a user."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache

import pytest

from benchmarks.strangers.machines import MACHINES
from benchmarks.strangers.recording import Simulated


@pytest.fixture(scope="session")
def machine() -> Callable[[str], Simulated]:
    """A machine's recording by the template's name, simulated once."""
    return cache(lambda kind: MACHINES[kind]())


@pytest.fixture
def recorded(machine, own_folder) -> Callable[[str], tuple[str, ...]]:
    """Writes ``kind.csv`` and gives the words that ``hybridid new`` needs for it."""

    def written(kind: str) -> tuple[str, ...]:
        (own_folder / f"{kind}.csv").write_text(machine(kind).text, encoding="utf-8")
        return ("--from", f"{kind}.csv", "--template", kind, *machine(kind).words)

    return written


@pytest.fixture
def rig(request) -> str:
    """A name for the machine that no other test uses: a module that was imported stays in the process."""
    return f"rig_{hashlib.sha256(request.node.nodeid.encode()).hexdigest()[:10]}"
