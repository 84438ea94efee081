"""Long records and long loops: 2.5 million samples are fitted, and loops keep their memory and processes."""

from __future__ import annotations

import gc
import multiprocessing
import os
import signal
import statistics
import sys
import threading
import time
from collections.abc import Callable
from contextlib import redirect_stderr, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.signal import cont2discrete, lfilter, ss2tf

from benchmarks.torture.bench import GROWS, LOST, WRONG, Fault, Found, Part
from benchmarks.torture.command import load, start
from benchmarks.torture.commands import QUICK
from hybridid_cli.composing import settings_of
from hybridid_cli.terminal import Terminal
from pipelines.runner import run_stages
from pipelines.shared.pool import mapper_of
from pipelines.shared.storage import read_json, write_table

SAMPLES = 2_500_000
DT = 1e-3
MASS, VISCOUS = 95.0, 210.0
"""Of the made machine, in kg and N·s/m."""
STIFFNESS = 9500.0
"""Of its position control, in N/m."""
NOISE = 5e-6
"""Standard deviation of the made position sensor, in m."""
CASE = """# @package _global_
case: {title: a long record}
plant: hybridid.plants.emps:EMPS
effects: [viscous]
signals:
  time: {column: t}
  inputs: {force: {column: force, unit: N, hold: zoh}}
  outputs: {position: {column: position, unit: m}}
records:
  long: {files: long.parquet, role: identification}
"""
ROUNDS = {"fits": 200, "pools": 60}
HOUR = 3600.0
WARM = 0.25
"""The share of the rounds after which memory is expected to stay."""
MORE = 0.05
"""The share by which memory may still grow."""


@dataclass(frozen=True)
class Long:
    """Something that takes long, called ``category``."""

    category: str
    counted: str
    done: Callable[[Path, int], Found]
    seed: int

    @property
    def key(self) -> str:
        return f"endurance: {self.category}, seed {self.seed}"

    def carried_out(self, bench: Path) -> Found:
        """Do it in a new folder."""
        if sys.platform != "linux":
            return Found("", skipped="reads memory and processes from /proc")
        load()
        with TemporaryDirectory(prefix="torture-") as folder:
            return self.done(Path(folder), self.seed)


def trials(seed: int) -> list[Long]:
    """All of them."""
    return [
        Long("2.5 million samples are fitted", "samples fitted", _long_record, seed),
        Long("a loop of fits", "fits in one process", partial(_apart, "fits"), seed),
        Long("a loop of pools", "pools in one process", partial(_apart, "pools"), seed),
        Long("an hour of fits", "hours of fits in one process", partial(_apart, "fits", seconds=HOUR), seed),
    ]


PART = Part(
    "endurance",
    "A long record is fitted by the command. Loops go on in one process, whose memory, processes, threads "
    "and open files must stay as they are.",
    (LOST, WRONG, GROWS),
    trials,
)


def _long_record(folder: Path, seed: int) -> Found:
    """Fit it by the command, in a process whose memory is measured."""
    (folder / "lab" / "case").mkdir(parents=True)
    (folder / "lab" / "case" / "long.yaml").write_text(CASE, encoding="utf-8")
    write_table(folder / "lab" / "long.parquet", _record(SAMPLES, seed), {})
    words = ("fit", "--config-dir", "lab", "case=long", "mlflow.enabled=false", "out=tree")
    began = time.monotonic()
    running = start(words, folder, fresh=True, says=folder / "said")
    _, status, used = os.wait4(running.pid, 0)
    seconds, code = time.monotonic() - began, os.waitstatus_to_exitcode(status)
    said = f"{seconds:.0f} s, {used.ru_maxrss / 2**20:.1f} GB at most"
    if code:
        return Found(said, (Fault(LOST, f"exit code {code}: {running.complaint()[-500:]}"),))
    fitted = read_json(folder / "tree" / "fit" / "estimate.json")["parameters"]
    values = {"M": MASS, "carriage.viscous.f_v": VISCOUS}
    far = [
        Fault(WRONG, f"{name} is {fitted[name]['value']} ± {fitted[name]['std']}, {true} was planted")
        for name, true in values.items()
        if abs(fitted[name]["value"] - true) > max(4 * fitted[name]["std"], 0.01 * true)
    ]
    return Found(said, tuple(far), {"samples fitted": float(SAMPLES)})


def _record(n: int, seed: int) -> dict[str, np.ndarray]:
    """A mass with viscous friction under position control, linear, so that its samples are exact."""
    generator = np.random.default_rng(seed)
    t = DT * np.arange(n)
    waves = generator.uniform(0.05, 2.0, 8), generator.uniform(0, 2 * np.pi, 8)
    reference = sum(0.02 * np.sin(2 * np.pi * f * t + phase) for f, phase in zip(*waves, strict=True))
    a, b, c, d, _ = cont2discrete(
        tuple(map(np.array, ([[0, 1], [0, -VISCOUS / MASS]], [[0], [1 / MASS]], [[1, 0]], [[0.0]]))), DT
    )
    closed = a - STIFFNESS * b @ c
    above, below = ss2tf(closed, STIFFNESS * b, c, d)
    position = lfilter(above[0], below, reference)
    force = STIFFNESS * (reference - position)
    return {"t": t, "force": force, "position": position + NOISE * generator.standard_normal(n)}


def _apart(what: str, folder: Path, seed: int, seconds: float = 0.0) -> Found:
    """Loop in a process of its own, whose memory is its own, for so many rounds and ``seconds`` at least."""
    ours, theirs = multiprocessing.Pipe()
    child = multiprocessing.get_context("fork").Process(target=_looped, args=(what, folder, theirs, seconds))
    child.start()
    theirs.close()
    try:
        memory, handles = ours.recv()
    except EOFError:
        child.join()
        return Found("", (Fault(LOST, f"the loop ended with {child.exitcode}"),))
    child.join()
    warm = int(WARM * len(memory))
    early, late = (statistics.median(part) for part in (memory[warm : 2 * warm], memory[-warm:]))
    faults = []
    if late > (1 + MORE) * early:
        faults.append(Fault(GROWS, f"memory from {early:.0f} to {late:.0f} MB"))
    before, after = (np.median(part, axis=0) for part in (handles[warm : 2 * warm], handles[-warm:]))
    if np.any(after > before):
        faults.append(Fault(GROWS, f"processes, threads and files from {before} to {after}"))
    said = f"{early:.0f} MB after {warm} rounds, {late:.0f} MB after {len(memory)}; {handles[-1]} at the end"
    counted = {f"hours of {what} in one process": seconds / HOUR} if seconds else {}
    return Found(said, tuple(faults), {f"{what} in one process": float(len(memory)), **counted})


def _looped(what: str, folder: Path, pipe: multiprocessing.connection.Connection, seconds: float) -> None:
    """Do the rounds and send the memory in MB, and the processes, threads and open files after each."""
    os.chdir(folder)
    gc.freeze()  # what was there before is no garbage of the rounds
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    one = {"fits": _fit, "pools": _pool}[what]
    memory, handles = [], []
    last = time.monotonic() + seconds
    while len(memory) < ROUNDS[what] or time.monotonic() < last:
        one(len(memory))
        gc.collect()
        resident = int(Path("/proc/self/statm").read_text().split()[1])
        memory.append(resident * os.sysconf("SC_PAGESIZE") / 1e6)
        handles.append((_children(), threading.active_count(), len(list(Path("/proc/self/fd").iterdir()))))
    pipe.send((memory, handles))


def _children() -> int:
    """How many processes are ours; a thread may end between its listing and its reading."""
    found = 0
    for task in Path("/proc/self/task").iterdir():
        with suppress(FileNotFoundError, ProcessLookupError):
            found += len((task / "children").read_text().split())
    return found


def _fit(number: int) -> None:
    """A fit of a record of another seed, logged to MLflow; thousands of them say nothing new."""
    from pipelines.tracking.runs import tracked

    settings = settings_of([*QUICK, f"rig.seed={number}"])
    with (
        Path(os.devnull).open("w") as nowhere,
        redirect_stderr(nowhere),
        Terminal(bar=False) as terminal,
        tracked(settings, "fit", terminal) as run,
    ):
        run.finish(run_stages(settings, "fit", terminal))


def _pool(number: int) -> None:
    """Two workers that do something and end."""
    with mapper_of(2) as mapper:
        assert list(mapper(abs, [(-number,), (number,)])) == [number, number]
