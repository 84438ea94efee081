"""Tasks side by side, each in a process of one thread; one that is killed does not touch the others."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import forkserver
from multiprocessing.connection import Connection, wait
from types import FrameType
from typing import Any, Generic, NoReturn, TypeVar

from pipelines.shared.watch import Watcher

Given = TypeVar("Given")
Result = TypeVar("Result")
THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")
METHOD = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
PATIENCE = 10.0
"""Seconds that a worker has to tidy up when it is told to stop."""
BETWEEN = 0.2
"""Seconds between two reports of progress."""


@dataclass(frozen=True)
class Died:
    """What became of a task whose process ended."""

    reason: str


class Stopped(BaseException):
    """The parent told this process to stop."""


@dataclass
class _Worker(Generic[Given, Result]):
    process: Any
    pipe: Connection
    task: str | None = None


def side_by_side(
    work: Callable[[Given, Watcher], Result],
    tasks: Mapping[str, Given],
    processes: int,
    watcher_of: Callable[[str], Watcher],
) -> Iterator[tuple[str, Result | Died]]:
    """``work(given, watcher)`` of every task, in ``processes`` processes; names and results as they come.

    ``work`` and what it takes and gives must pickle. What it tells its watcher reaches
    ``watcher_of(name)`` in this process. Whatever ends the iteration ends the processes.
    """
    waiting = list(tasks)
    workers: list[_Worker[Given, Result]] = []
    try:
        while waiting or any(worker.task for worker in workers):
            idle = [worker for worker in workers if worker.task is None]
            while waiting and (idle or len(workers) < processes):
                if not idle:
                    try:
                        idle.append(_started(work))
                    except (EOFError, OSError):  # the server that forks it is gone; the next one starts anew
                        yield waiting.pop(0), Died("its process was killed as it started")
                        continue
                    workers.append(idle[-1])
                worker, name = idle.pop(), waiting.pop(0)
                worker.task = name
                watcher_of(name).say("begins")
                worker.pipe.send(tasks[name])
            for pipe in wait([worker.pipe for worker in workers if worker.task]):
                worker = next(w for w in workers if w.pipe is pipe)
                yield from _heard(worker, workers, watcher_of)
    finally:
        for worker in workers:
            _end(worker)


def _heard(
    worker: _Worker[Given, Result],
    workers: list[_Worker[Given, Result]],
    watcher_of: Callable[[str], Watcher],
) -> Iterator[tuple[str, Result | Died]]:
    """One message of a worker: a result, or something for the watcher."""
    name = worker.task
    assert name is not None
    try:
        kind, said = worker.pipe.recv()
    except (EOFError, ConnectionResetError):
        workers.remove(worker)
        worker.process.join()
        yield name, Died(_how(worker.process.exitcode))
        return
    if kind == "result":
        worker.task = None
        yield name, said
    else:
        getattr(watcher_of(name), kind)(*said)


def _how(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        return f"its process was killed by {signal.Signals(-exitcode).name}"
    return f"its process ended with code {exitcode}"


def load_early(*modules: str) -> None:
    """Begin to import ``modules`` in the process that workers are forked from, while this one goes on: torch
    and scipy take seconds. Does nothing where processes cannot be forked."""
    if METHOD == "forkserver":
        multiprocessing.get_context(METHOD).set_forkserver_preload(list(modules))
        with _one_thread():
            forkserver.ensure_running()


def _started(work: Callable[[Given, Watcher], Result]) -> _Worker[Given, Result]:
    context: Any = multiprocessing.get_context(METHOD)
    ours, theirs = context.Pipe()
    with _one_thread():
        environment = dict(os.environ)
    process = context.Process(target=_serve, args=(work, theirs, environment))
    with _one_thread():
        process.start()
    theirs.close()
    return _Worker(process, ours)


def _end(worker: _Worker[Given, Result]) -> None:
    """An idle worker ends when its pipe closes; a busy one is told to stop, and killed if it does not."""
    worker.pipe.close()
    if worker.task is not None:
        worker.process.terminate()
    worker.process.join(PATIENCE)
    if worker.process.is_alive():
        worker.process.kill()
        worker.process.join()


@contextmanager
def _one_thread() -> Iterator[None]:
    """Processes fill the cores: threads inside them would only fight."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


class _Teller:
    """The watcher inside a worker: passes on what is said; raises if the parent has said stop."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe = pipe
        self._last = ("", 0.0)

    def say(self, line: str) -> None:
        self._tell("say", line)

    def warn(self, line: str) -> None:
        self._tell("warn", line)

    def carry_on(self) -> None:
        if _stopped:
            raise Stopped

    def progress(self, work: str, state: str, fraction: float | None) -> None:
        self.carry_on()
        now = time.monotonic()
        if work != self._last[0] or now - self._last[1] > BETWEEN:
            self._last = (work, now)
            self._tell("progress", work, state, fraction)

    def _tell(self, kind: str, *said: Any) -> None:
        self.carry_on()
        self._pipe.send((kind, said))


_stopped = False


def _stop(number: int, frame: FrameType | None) -> NoReturn:
    """Remembered, for a library may swallow the exception."""
    global _stopped
    _stopped = True
    raise Stopped


def _outlive_nobody() -> None:
    """Ends this process soon after its parent, which may have been killed without a word."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(PATIENCE)
    os._exit(1)


def _serve(work: Callable[[Any, Watcher], Any], pipe: Connection, environment: Mapping[str, str]) -> None:
    """A worker's life: tasks come and results go through ``pipe`` until it closes."""
    os.environ.update(environment)  # what it was forked from may be older than a setting
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the parent, which says what to do
    signal.signal(signal.SIGTERM, _stop)
    threading.Thread(target=_outlive_nobody, daemon=True).start()
    try:
        while True:
            pipe.send(("result", work(pipe.recv(), _Teller(pipe))))
    except (EOFError, BrokenPipeError, ConnectionResetError, Stopped):
        return
