"""A cache of compiled models, or of unfinished results, in which somebody put code: it is not loaded."""

from __future__ import annotations

import json
import os
import pickle
import signal
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from benchmarks.torture.bench import RAN, WRONG, Fault, Found
from benchmarks.torture.case import BORNE, Case
from benchmarks.torture.command import start
from benchmarks.torture.inputs import wrong_in
from benchmarks.torture.play import answer, load, new_folder
from benchmarks.torture.tables.decoys import CANARY, Bomb, compiled
from benchmarks.torture.tables.received import QUICK
from hybridid.private import sealed

MODELS, UNFINISHED = Path(".cache/hybridid/models"), Path(".cache/hybridid/unfinished")
OTHER = 65534
"""A user who is nobody here."""
SECONDS = 300.0
ENOUGH = 3
"""Results after which a trace is interrupted."""
# a shorter record is simulated without compiling
FIT = ("fit", *("rig.duration=8" if word.startswith("rig.") else word for word in QUICK))
TRACE = ("trace", *QUICK, "trace.effects=[stribeck]", "trace.processes=1")
Poison = Callable[[Path, bytes], object]
"""What is done with a file of the cache, given code that runs when it is loaded."""


def _put(path: Path, code: bytes) -> None:
    """Write code with the right seal: only who may write here can do this."""
    path.write_bytes(sealed(path.name, code))
    path.chmod(0o600)


def _put_and(change: Callable[[Path], object]) -> Poison:
    def poison(path: Path, code: bytes) -> None:
        _put(path, code)
        change(path)

    return poison


def _link(path: Path, code: bytes) -> None:
    elsewhere = path.with_name("elsewhere") / path.name
    elsewhere.parent.mkdir(exist_ok=True)
    _put(elsewhere, code)
    path.unlink()
    path.symlink_to(elsewhere)


def _pipe(path: Path, code: bytes) -> None:
    path.unlink()
    os.mkfifo(path)


POISONS: Mapping[str, Poison] = {
    "without a seal": Path.write_bytes,
    "with the seal of another": lambda path, code: path.write_bytes(sealed(f"x{path.name}", code)),
    "in a folder that others may write to": _put_and(lambda path: path.parent.chmod(0o777)),
    "in a file of another user": _put_and(lambda path: os.chown(path, OTHER, OTHER)),
    "in a folder of another user": _put_and(lambda path: os.chown(path.parent, OTHER, OTHER)),
    "in a file that others may write to": _put_and(lambda path: path.chmod(0o666)),
    "behind a link": _link,
    "a file cut off": lambda path, code: path.write_bytes(path.read_bytes()[:8000]),
    "a file of random bytes": lambda path, code: path.write_bytes(os.urandom(len(path.read_bytes()))),
    "an empty file": lambda path, code: path.write_bytes(b""),
    "a pipe": _pipe,
}
CONTROL = "control: sealed, in a folder of one's own"
NEEDS_ROOT = {"in a file of another user", "in a folder of another user"}


@dataclass(frozen=True)
class Poisoned:
    """A command whose cache was filled by an earlier one, and then ``poison``ed."""

    what: str
    name: str
    poison: Poison
    seed: int

    @property
    def key(self) -> str:
        return f"received: {self.what}, {self.name}, seed {self.seed}"

    @property
    def category(self) -> str:
        return self.what

    def carried_out(self, bench: Path) -> Found:
        """Fill the cache, poison it, and give the command again."""
        if sys.platform != "linux" or (self.name in NEEDS_ROOT and os.geteuid() != 0):
            return Found("", skipped="only root can give a file to another user")
        load()
        models = self.what == "compiled models"
        canary = bench / "canary"
        canary.unlink(missing_ok=True)
        with new_folder(bench) as folder:
            own = {CANARY: str(canary), "XDG_CACHE_HOME": str(folder / ".cache")}
            files = _compiled(folder, own) if models else _interrupted(folder, own)
            code = _machine_code(folder) if models else pickle.dumps(Bomb())
            honest = _values(folder / "tree") if models else {}
            for path in files:
                self.poison(path, code)
            again = (*FIT[:-1], "out=again") if models else TRACE
            said = answer(again, folder, SECONDS, own)
            same = not models or _values(folder / "again") == honest
        wrong = [] if files else [Fault(WRONG, "there was nothing to poison")]
        if self.name == CONTROL:
            if not canary.exists():
                wrong.append(Fault(WRONG, f"the code in {len(files)} files does not run where it may"))
        else:
            case = Case(self.key, again, codes=BORNE, seconds=SECONDS)
            wrong += wrong_in(case, said)
            wrong += [Fault(RAN, said.complaint[:200])] if canary.exists() else []
            wrong += [] if same else [Fault(WRONG, "other parameters than from a sound cache")]
        counts = {"received files": float(len(files))}
        return Found(f"{len(files)} files: {said}", tuple(wrong), counts)


def trials(seed: int) -> list[Poisoned]:
    """Of each way to put code there, for compiled models and for unfinished results."""
    ways = {**POISONS, CONTROL: _put}
    kinds = ("compiled models", "unfinished results")
    return [Poisoned(what, name, poison, seed) for what in kinds for name, poison in ways.items()]


def _compiled(folder: Path, own: Mapping[str, str]) -> list[Path]:
    """The libraries that a fit leaves."""
    answer(FIT, folder, SECONDS, own)
    return sorted((folder / MODELS).glob("*.so"))


def _machine_code(folder: Path) -> bytes:
    made = folder / "decoy.so"
    compiled(made)
    return made.read_bytes()


def _interrupted(folder: Path, own: Mapping[str, str]) -> list[Path]:
    """The results that an interrupted trace leaves."""
    running = start(TRACE, folder, environment=own, says=folder / "said")
    until = time.monotonic() + SECONDS
    while len(_results(folder)) < ENOUGH and not running.waited(0.01) and time.monotonic() < until:
        pass
    running.strike(signal.SIGTERM)
    running.waited(SECONDS)
    return _results(folder)


def _results(folder: Path) -> list[Path]:
    return sorted(path for path in (folder / UNFINISHED).glob("*/[!.]*") if path.is_file())


def _values(tree: Path) -> Mapping[str, float]:
    """The parameters of a fit."""
    file = tree / "fit" / "estimate.json"
    content = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {"parameters": {}}
    return {name: about["value"] for name, about in content["parameters"].items()}
