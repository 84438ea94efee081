"""Many at once and many in a row: commands on one folder, writers to one MLflow store, runs in one store."""

from __future__ import annotations

import multiprocessing
import statistics
import time
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.torture import whole
from benchmarks.torture.bench import GROWS, HANGS, LOST, TRACEBACK, UNCLEAR, WRONG, Fault, Found, Part
from benchmarks.torture.command import load
from benchmarks.torture.commands import WITH_CONFIG, Command
from benchmarks.torture.reference import ended, reference, started
from hybridid_cli.terminal import Terminal
from pipelines.shared.config import Settings
from pipelines.tracking.abandoned import end_abandoned
from pipelines.tracking.parent_run import parent_run
from pipelines.tracking.runs import Point, log_point
from pipelines.tracking.waiting import send_waiting, waiting

EACH = 2
"""Pairs of each command, the second begun at a moment that the seed draws."""
WRITERS, RUNS_EACH, STRUCK = 16, 8, 4
"""Processes that write to one store, runs of each, and how many of them are killed meanwhile."""
RUNS, PART_OF_RUNS, SLOWER = 2000, 200, 2.0
"""Runs in one store. The last ``PART_OF_RUNS`` of them may take ``SLOWER`` times the CPU of the first."""


@dataclass(frozen=True)
class Pair:
    """One command twice at once on one folder."""

    command: Command
    number: int
    seed: int
    category = "two commands on one folder"

    @property
    def key(self) -> str:
        return f"stores: two {self.command.name} at once, seed {self.seed}.{self.number}"

    def carried_out(self, bench: Path) -> Found:
        """Start it twice, wait for both, and compare with one alone."""
        load()
        with self.command.around():
            done = reference(self.command, bench)
            done.restored()
            name = zlib.crc32(self.command.name.encode())
            later = float(np.random.default_rng([self.seed, name, self.number]).uniform(0, done.seconds))
            first = started(done.words, done.lab)
            time.sleep(later)
            second = started(done.words, done.lab, says="second")
            faults: list[Fault] = []
            for running in (first, second):
                faults += ended(running)
                if running.code:
                    faults.append(Fault(UNCLEAR, f"exit code {running.code}: {running.last()[:300]}"))
            faults += done.lost(whole.contents(done.before / "outputs"))
            faults += done.differences()
        return Found(f"the second {later:.1f} s later", tuple(faults), {"pairs of commands": 1.0})


@dataclass(frozen=True)
class Store:
    """Something with a store of its own, called ``name``."""

    name: str
    counted: str
    done: Callable[[Path, int], tuple[str, float, list[Fault]]]
    seed: int

    @property
    def key(self) -> str:
        return f"stores: {self.name}, seed {self.seed}"

    @property
    def category(self) -> str:
        return self.name

    def carried_out(self, bench: Path) -> Found:
        """Do it in a new folder."""
        load()
        with TemporaryDirectory(prefix="torture-") as folder:
            said, count, faults = self.done(Path(folder), self.seed)
        return Found(said, tuple(faults), {self.counted: count})


def trials(seed: int) -> list[Pair | Store]:
    """All of them."""
    return [
        Store(
            f"{WRITERS} writers to one store, {STRUCK} of them killed", "runs by many writers", _writers, seed
        ),
        Store(f"{RUNS} runs in one store", "runs in one store", _many_runs, seed),
        *(Pair(command, number, seed) for number in range(EACH) for command in WITH_CONFIG),
    ]


PART = Part(
    "stores",
    "Many processes write to one MLflow store, and some of them are killed. Many runs go to one store. Each "
    "command runs twice at once on one folder, the second from a random moment on.",
    (LOST, WRONG, TRACEBACK, UNCLEAR, HANGS, GROWS),
    trials,
)


def _settings(outputs: Path) -> Settings:
    return Settings("many", {"paths": {"outputs": str(outputs)}, "mlflow": {"enabled": True}})


def _point(key: str, folder: Path) -> Point:
    """A point with numbers and a file."""
    numbers = {f"number.{k}": k / 7 for k in range(5)}
    return Point(key, key, {"width": key}, numbers, time.time(), 1.0, artifacts=[folder / "curve.json"])


def _writers(folder: Path, seed: int) -> tuple[str, float, list[Fault]]:
    """Processes begin together on a store that is not there. Some are killed, and write again."""
    (folder / "curve.json").write_text("[1]\n", encoding="utf-8")
    fork = multiprocessing.get_context("fork")
    begin = fork.Event()
    writers = [fork.Process(target=_write, args=(folder, n, begin)) for n in range(WRITERS)]
    for writer in writers:
        writer.start()
    begin.set()
    generator = np.random.default_rng(seed)
    for n in range(STRUCK):
        time.sleep(float(generator.uniform(0.5, 3.0)))
        writers[n].kill()
    for writer in writers:
        writer.join()
    again = [fork.Process(target=_write, args=(folder, n, begin)) for n in range(STRUCK)]
    for writer in again:
        writer.start()
    for writer in again:
        writer.join()
    with Terminal() as terminal:
        sent = list(send_waiting(_settings(folder), terminal))
    end_abandoned(_settings(folder))
    faults = list(_wrong(folder, {f"{n}.{k}" for n in range(WRITERS) for k in range(RUNS_EACH)}))
    faults += [Fault(LOST, f"exit code {w.exitcode}") for w in (*writers[STRUCK:], *again) if w.exitcode]
    return f"{len(sent)} of the runs had to wait, and were sent", float(WRITERS * RUNS_EACH), faults


def _write(folder: Path, number: int, begin: multiprocessing.synchronize.Event) -> None:
    begin.wait()
    with Terminal() as terminal:
        for k in range(RUNS_EACH):
            log_point(_settings(folder), _point(f"{number}.{k}", folder), "all", terminal)


def _wrong(folder: Path, keys: set[str]) -> Iterator[Fault]:
    """What is wrong with a store that must hold each of ``keys`` once, whole."""
    yield from (Fault(LOST, f"waits: {note.key}") for _, note in waiting(_settings(folder)))
    rows = whole.rows(
        folder / "mlflow.db",
        "select t.value, r.status, count(m.key) from runs r "
        "join tags t on t.run_uuid = r.run_uuid and t.key = 'hybridid.key' "
        "left join latest_metrics m on m.run_uuid = r.run_uuid group by r.run_uuid",
    )
    found = [(str(key), status, count) for key, status, count in rows if key != "all"]
    for key in sorted(keys - {key for key, *_ in found}):
        yield Fault(LOST, f"no run {key}")
    if len(found) != len({key for key, *_ in found}):
        yield Fault(LOST, "two runs of one key")
    for key, status, count in found:
        if (status, count) != ("FINISHED", 5):
            yield Fault(LOST, f"run {key} is {status} with {count} of 5 numbers")


def _many_runs(folder: Path, seed: int) -> tuple[str, float, list[Fault]]:
    """As a sweep of so many points logs them."""
    (folder / "curve.json").write_text("[1]\n", encoding="utf-8")
    taken = []
    with Terminal() as terminal, parent_run(_settings(folder), "many", "all", terminal) as parent:
        parent.open({})
        for n in range(RUNS):
            began = time.process_time()  # other work on the machine does not count
            log_point(_settings(folder), _point(str(n), folder), "all", terminal)
            taken.append(time.process_time() - began)
        parent.close()
    first, last = (statistics.median(part) for part in (taken[:PART_OF_RUNS], taken[-PART_OF_RUNS:]))
    faults = list(_wrong(folder, {str(n) for n in range(RUNS)}))
    if last > SLOWER * first:
        faults.append(Fault(GROWS, f"a run takes {last:.3f} s of CPU, {first:.3f} s at the beginning"))
    size = (folder / "mlflow.db").stat().st_size / 1e6
    said = f"median {first:.3f} s of CPU a run at first, {last:.3f} s at the end; the store has {size:.0f} MB"
    return said, float(RUNS), faults
