"""The one-node Slurm, and the job of a sweep that is killed on it on purpose."""

from __future__ import annotations

import math
import os
import re
import signal
import subprocess
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

ONE_NODE = Path(__file__).with_name("one_node.sh")


@dataclass(frozen=True)
class Kill:
    """Which job is killed: of the ``array`` (0 the first), once ``ended`` jobs have ended, one that began
    ``youngest`` to ``oldest`` seconds ago.

    ``at_once``: by ``kill -9`` of all its processes, as when its node dies; else by Slurm.
    """

    array: int = 0
    ended: int = 3
    youngest: float = 0.0
    oldest: float = math.inf
    at_once: bool = False


def cluster() -> dict[str, str]:
    """Bring it up; the environment in which its commands find it."""
    root = os.environ.get("HYBRIDID_SLURM", "/tmp/hybridid-slurm")
    subprocess.run([str(ONE_NODE), "up"], check=True)
    found = {"SLURM_CONF": f"{root}/slurm.conf", "MLFLOW_DISABLE_TELEMETRY": "true"}
    return {**os.environ, **found, "PYTHONPATH": str(Path(__file__).parents[2])}


def struck(
    command: Sequence[str], folder: Path, environment: Mapping[str, str], kill: Kill
) -> tuple[str, int, str]:
    """Start a sweep in ``folder`` and kill a job of it; that job, the exit code, and what the sweep said."""
    began, log = time.monotonic(), folder / "first.log"
    with log.open("w") as stream:
        sweep = subprocess.Popen(command, cwd=folder, env=environment, stdout=stream, stderr=stream)
        killed = kill_one(sweep, log, environment, kill)
        print(f"killed on purpose after {time.monotonic() - began:.0f} s: job {killed or 'none'}", flush=True)
        code = sweep.wait()
    print(f"first: {time.monotonic() - began:.0f} s, exit code {code}")
    return killed, code, log.read_text()


def again(command: Sequence[str], folder: Path, environment: Mapping[str, str]) -> tuple[int, str]:
    """Give the command again; its exit code, and what it said."""
    began = time.monotonic()
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    said = done.stderr + done.stdout
    (folder / "again.log").write_text(said)
    print(f"again: {time.monotonic() - began:.0f} s, exit code {done.returncode}")
    return done.returncode, said


def kill_one(sweep: subprocess.Popen[bytes], log: Path, environment: Mapping[str, str], kill: Kill) -> str:
    """Kill a job of the ``sweep`` whose lines are in ``log``; its id, empty if the sweep ended before.

    At once: a job that is merely cancelled has half a minute to end, and may be done by then.
    """
    while sweep.poll() is None:
        time.sleep(0.1)
        jobs = launched(log.read_text(), kill.array)
        ended = [path for path in jobs if path.with_suffix(".outcome").exists()]
        ages = {path: _age(path.with_suffix(".begun")) for path in jobs if path not in ended}
        begun = [path for path, age in ages.items() if kill.youngest <= age < kill.oldest]
        if len(ended) >= kill.ended and begun:
            job = jobs[begun[0]]
            if kill.at_once:
                for process in _processes_of(job):
                    with suppress(ProcessLookupError):
                        os.kill(process, signal.SIGKILL)
            else:
                subprocess.run(["scancel", "--signal=KILL", job], env=environment, check=True)
            return job
    return ""


def _processes_of(job: str) -> list[int]:
    """Those on this machine that Slurm started for a job of an array, and their children."""
    array, _, task = job.partition("_")
    wanted = {f"SLURM_ARRAY_JOB_ID={array}".encode(), f"SLURM_ARRAY_TASK_ID={task}".encode()}
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # it ended meanwhile, or is another user's
            if wanted <= set((place / "environ").read_bytes().split(b"\0")):
                found.append(int(place.name))
    return found


def _age(path: Path) -> float:
    """Seconds since it was written; without end if it is not there."""
    return time.time() - path.stat().st_mtime if path.exists() else math.inf


def launched(said: str, array: int) -> dict[Path, str]:
    """The jobs of an array by their files, as the launcher wrote them; each array goes on counting."""
    parts = re.split(r"submitted to Slurm as job (\d+)", said)
    if len(parts) < 2 * array + 2:
        return {}
    files = re.findall(r"#\d+ : .*sweep\.job=(\S+)", parts[2 * array])
    return {Path(path): f"{parts[2 * array + 1]}_{number}" for number, path in enumerate(files)}
