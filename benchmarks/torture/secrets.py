"""Passwords and tokens that a command is given: none may stand in anything that it writes or says."""

from __future__ import annotations

import base64
import sys
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.torture.bench import HANGS, SECRET, TRACEBACK, Fault, Found, Part
from benchmarks.torture.command import load
from benchmarks.torture.commands import WITH_CONFIG, Command
from benchmarks.torture.reference import ended, prepared, started

USER = "torture"
PLACES = ("the address of a tracking server", "MLFLOW_TRACKING_TOKEN", "AWS_SECRET_ACCESS_KEY")
"""Where a secret is planted."""


@dataclass(frozen=True)
class Planted:
    """A command that is given secrets drawn from ``seed``; its server does not answer, so its run is kept."""

    command: Command
    seed: int

    @property
    def key(self) -> str:
        return f"secrets: {self.command.name}, seed {self.seed}"

    @property
    def category(self) -> str:
        return self.command.name

    def carried_out(self, bench: Path) -> Found:
        """Run the command and search all that it wrote."""
        if sys.platform != "linux":
            return Found("", skipped="finds processes in /proc")
        load()
        drawn = np.random.default_rng([self.seed, zlib.crc32(self.command.name.encode())])
        secrets = {place: drawn.bytes(12).hex() for place in PLACES}
        lab = bench / "lab"
        with self.command.around():
            words = [w for w in prepared(self.command, lab) if not w.startswith("mlflow.")]
            address, token, key = secrets.values()
            words.append(f"mlflow.tracking_uri=http://{USER}:{address}@127.0.0.1:9")
            running = started(
                tuple(words), lab, more={"MLFLOW_TRACKING_TOKEN": token, "AWS_SECRET_ACCESS_KEY": key}
            )
            faults = list(ended(running))
        files = [running.out, running.err, *(path for path in lab.rglob("*") if path.is_file())]
        for path in files:
            content = path.read_bytes()
            for place, secret in secrets.items():
                if any(written in content for written in spellings(secret)):
                    faults.append(Fault(SECRET, f"that of {place} in {path.relative_to(bench)}"))
        counts = {"secrets planted": float(len(secrets)), "files searched": float(len(files))}
        return Found(f"exit code {running.code}, {len(files)} files searched", tuple(faults), counts)


def spellings(secret: str) -> tuple[bytes, ...]:
    """As it is, and as a header of HTTP would have it."""
    return secret.encode(), base64.b64encode(f"{USER}:{secret}".encode())


def trials(seed: int) -> list[Planted]:
    """All commands that read a config."""
    return [Planted(command, seed) for command in WITH_CONFIG]


PART = Part(
    "secrets",
    f"Each command is given a secret in {', in '.join(PLACES)}. Its tracking server does not answer, so that "
    "its runs are kept for later. All that it wrote and said is searched for the secrets.",
    (SECRET, TRACEBACK, HANGS),
    trials,
)
