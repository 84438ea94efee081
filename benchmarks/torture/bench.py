"""What all parts share: a trial, what it found, and the lines that a later run goes on with."""

from __future__ import annotations

import hashlib
import json
import platform
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Protocol

from benchmarks.answers import append

ROOT = Path(__file__).parents[2]
CODE = ("hybridid", "pipelines", "hybridid_cli", "hydra_plugins", "conf", "benchmarks/torture")
Line = Mapping[str, Any]

LOST = "lost"
"""A result that was there is gone, or the same command again does not complete it."""
WRONG = "silent wrong"
"""Other numbers than without the trouble, or an exit code that says that all is well."""
HALF = "half-written"
TRACEBACK = "traceback"
UNCLEAR = "no clear line"
ORPHAN = "orphan"
RAN = "code run from a received file"
SECRET = "secret found"
HANGS = "hangs"
GROWS = "grows"
KINDS = (LOST, WRONG, HALF, TRACEBACK, UNCLEAR, ORPHAN, RAN, SECRET, HANGS, GROWS)


@dataclass(frozen=True)
class Fault:
    """One thing that broke; ``kind`` is of ``KINDS``."""

    kind: str
    what: str


@dataclass(frozen=True)
class Found:
    """What came of a trial: in words, what broke, and what is counted, as ``{"kills": 1}``.

    ``skipped`` says why it could not be carried out here.
    """

    said: str
    faults: tuple[Fault, ...] = ()
    counts: Mapping[str, float] = field(default_factory=dict)
    skipped: str = ""


class Trial(Protocol):
    """``key`` is unique and names the seed; ``category`` is a row of the table of its ``part``."""

    @property
    def key(self) -> str: ...
    @property
    def part(self) -> str: ...
    @property
    def category(self) -> str: ...
    def carried_out(self, bench: Path) -> Found:
        """Do it; ``bench`` is a folder that all trials of a run share."""
        ...


@cache
def version() -> str:
    """SHA-256 of the code that is tortured and of that which does it."""
    files = sorted(f for name in CODE for f in (ROOT / name).rglob("*") if f.suffix in (".py", ".c", ".yaml"))
    digest = hashlib.sha256()
    for file in files:
        digest.update(str(file.relative_to(ROOT)).encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()[:16]


def known(file: Path, trials: Iterable[Trial], any_code: bool) -> dict[str, Line]:
    """The last line of each of ``trials`` in ``file``, by key; a line of other code only if ``any_code``."""
    keys = {trial.key for trial in trials}
    found: dict[str, Line] = {}
    for text in file.read_text(encoding="utf-8").splitlines() if file.exists() else ():
        try:
            line = json.loads(text)
        except json.JSONDecodeError:
            continue  # cut off when its run was killed
        if line["key"] in keys and (any_code or line["version"] == version()):
            found[line["key"]] = line
    return found


def conducted(trials: Sequence[Trial], file: Path, any_code: bool) -> Iterator[Line]:
    """Carry out the trials that ``file`` does not hold yet, or with a fault; append each, and yield it."""
    there = known(file, trials, any_code)
    file.parent.mkdir(parents=True, exist_ok=True)
    for trial in trials:
        if trial.key in there and not there[trial.key]["faults"]:
            continue
        began = time.monotonic()
        found = trial.carried_out(file.parent / "bench")
        line = {
            "key": trial.key,
            "part": trial.part,
            "category": trial.category,
            "version": version(),
            "date": time.strftime("%Y-%m-%d"),
            "machine": machine(),
            "seconds": round(time.monotonic() - began, 2),
            **asdict(found),
        }
        append(file, [line])
        yield json.loads(json.dumps(line))


@cache
def machine() -> str:
    """This machine in a few words."""
    from joblib import cpu_count

    return f"{platform.system()} {platform.release()}, {platform.machine()}, {cpu_count()} cores, " + (
        f"Python {platform.python_version()}"
    )
