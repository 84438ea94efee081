"""``fetch`` from a server whose archive is not the published one: nothing is written outside its folder."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from benchmarks.torture.bench import HALF, RAN, Fault, Found
from benchmarks.torture.case import Case
from benchmarks.torture.inputs import wrong_in
from benchmarks.torture.mirror import Answer, mirror, zipped
from benchmarks.torture.play import answer, load, new_folder
from benchmarks.torture.tables.archives import ARCHIVES, MOST, SERVERS, Archive

WORDS = ("fetch", "emps", "paths.data=data/raw", "mlflow.enabled=false")
SECONDS = 60.0
OWN = (".lock", ".emps.part")
"""What ``fetch`` may leave in its folder: a lock, and what it has, to go on with."""


@dataclass(frozen=True)
class Fetched:
    """An archive that a server sends in its own way."""

    name: str
    archive: Archive
    answers: Answer | None
    seed: int
    category = "archives"

    @property
    def key(self) -> str:
        return f"received: archive, {self.name}, seed {self.seed}"

    def carried_out(self, bench: Path) -> Found:
        """Fetch it, and look at what was written."""
        load()
        with new_folder(bench) as folder:
            outside = folder / "outside"
            with mirror(self.archive(str(outside)), self.answers, MOST):
                said = answer(WORDS, folder, SECONDS)
            written = [path for path in folder.rglob("*") if path.is_file() or path.is_symlink()]
        case = Case(self.key, WORDS, seconds=SECONDS)
        said = replace(said, left=())  # what is left is looked at below
        wrong = wrong_in(case, said)
        for path in written:
            home = folder / "data" / "raw" / "emps"
            if not path.is_relative_to(home) and "outputs" not in path.parts:
                wrong.append(Fault(RAN, f"{path.relative_to(folder)} was written"))
            elif path.is_relative_to(home) and path.name not in OWN:
                wrong.append(Fault(HALF, f"{path.relative_to(folder)} was left"))
        return Found(str(said), tuple(wrong), {"received files": 1.0})


def trials(seed: int) -> list[Fetched]:
    """Of each archive and each server."""
    sent = [Fetched(name, archive, None, seed) for name, archive in ARCHIVES.items()]
    return sent + [Fetched(name, lambda outside: zipped({}), way, seed) for name, way in SERVERS.items()]
