"""What all parts share: a trial, what it found, and the lines that a later run goes on with."""

from __future__ import annotations

import hashlib
import json
import platform
import shutil
import subprocess
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, Protocol

from benchmarks.answers import append, lines_of

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
    """``key`` is unique and names the seed; ``category`` is a row of the table of its part."""

    @property
    def key(self) -> str: ...
    @property
    def category(self) -> str: ...
    @property
    def seed(self) -> int: ...
    def carried_out(self, bench: Path) -> Found:
        """Do it; ``bench`` is a folder that all trials of a run share."""
        ...


@dataclass(frozen=True, eq=False)
class Part:
    """A section of the page: what its trials do, in a sentence or two, and the kinds of fault that they look
    for. ``asked`` says how many at least, by what is counted. ``trials(seed)`` are all of its trials."""

    name: str
    about: str
    seeks: tuple[str, ...]
    trials: Callable[[int], Sequence[Trial]]
    asked: Mapping[str, int] = field(default_factory=dict)


@cache
def version() -> str:
    """SHA-256 of the code that is tortured and of that which does it."""
    files = sorted(f for name in CODE for f in (ROOT / name).rglob("*") if f.suffix in (".py", ".c", ".yaml"))
    digest = hashlib.sha256()
    for file in files:
        digest.update(str(file.relative_to(ROOT)).encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()[:16]


def known(file: Path, trials: Iterable[Trial]) -> dict[str, Line]:
    """The last line of each of ``trials`` in ``file``, by key, in the order of the trials. ``earlier`` in it
    are the faults of the lines before it."""
    keys = [trial.key for trial in trials]
    found: dict[str, Line] = {}
    for line in lines_of(file):
        before = found.get(line["key"], {"earlier": [], "faults": []})
        found[line["key"]] = {**line, "earlier": [*before["earlier"], *before["faults"]]}
    return {key: found[key] for key in keys if key in found}


def conducted(part: str, trials: Sequence[Trial], file: Path, any_code: bool) -> Iterator[Line]:
    """Carry out the trials that ``file`` does not hold yet, or with a fault, or unless ``any_code`` of other
    code; append each, and yield it."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with bench(file.parent.resolve()) as folder:
        for trial in undone(trials, file, any_code):
            began = time.monotonic()
            found = trial.carried_out(folder)
            line = {
                "key": trial.key,
                "part": part,
                "category": trial.category,
                "seed": trial.seed,
                "version": version(),
                "commit": commit(),
                "date": time.strftime("%Y-%m-%d"),
                "machine": machine(),
                "seconds": round(time.monotonic() - began, 2),
                **asdict(found),
            }
            append(file, [line])
            yield json.loads(json.dumps(line))


@contextmanager
def bench(folder: Path) -> Iterator[Path]:
    """A new folder in ``folder``. A TemporaryDirectory would go when the first command forked from here ends,
    for that command tidies up as Python does at its end."""
    made = Path(mkdtemp(prefix="bench-", dir=folder))
    try:
        yield made
    finally:
        shutil.rmtree(made)


def undone(trials: Sequence[Trial], file: Path, any_code: bool) -> list[Trial]:
    """The trials that ``conducted`` has to carry out."""
    sound = {
        key
        for key, line in known(file, trials).items()
        if not line["faults"] and (any_code or line["version"] == version())
    }
    return [trial for trial in trials if trial.key not in sound]


@cache
def commit() -> str:
    """The commit of the code that is tortured, and whether files were changed since."""
    try:
        name, changed = (
            _git(*words) for words in (("rev-parse", "--short", "HEAD"), ("status", "--short", *CODE))
        )
    except (OSError, subprocess.CalledProcessError):
        return "not in git"
    return f"{name} with changes" if changed else name


def _git(*words: str) -> str:
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout.strip()


@cache
def machine() -> str:
    """This machine in a few words."""
    from joblib import cpu_count

    return f"{platform.system()} {platform.release()}, {platform.machine()}, {cpu_count()} cores, " + (
        f"Python {platform.python_version()}"
    )
