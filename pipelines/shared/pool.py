"""Single-threaded processes that work side by side. A process that is killed costs only its own task.

``side_by_side`` does named tasks and passes on the messages of each. ``mapper_of`` gives results in order,
for refits. Both stand on ``Pool``.

Three libraries were tried before this was kept (Linux, Python 3.11, 2026-11):

- ``concurrent.futures`` and loky 3.7 (joblib): a worker that is killed breaks the pool, and the other four
  of five tasks are lost with it.
- pebble 5.2.3: a worker that is killed costs its own task. But workers share one pipe: after one was killed
  while it sent a result, no further result came within 20 s.
- All three: workers still ran 5 s after ``kill -9`` of the parent. None reports a task's progress.

Here each worker has a pipe of its own, and ends when its parent does.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from itertools import chain, islice
from multiprocessing.connection import Connection, wait
from typing import Any, TypeVar

from hybridid.private import cache_folder
from hybridid.trace.mapper import Mapper, serial
from pipelines.shared.own_code import importable
from pipelines.shared.parent_process import PATIENCE
from pipelines.shared.pool_server import METHOD, ensure_server, one_thread
from pipelines.shared.pool_worker import ENDED, Lost, Packed, serve
from pipelines.shared.watch import Watcher

__all__ = ["Lost", "Pool", "core_count", "load_early", "mapper_of", "side_by_side"]

Given = TypeVar("Given")
Result = TypeVar("Result")
Key = TypeVar("Key")
Work = Callable[[Any, Watcher], Any]


def core_count() -> int:
    """The cores that this process may use."""
    from joblib import cpu_count

    return int(cpu_count())


def side_by_side(
    work: Callable[[Given, Watcher], Result],
    tasks: Mapping[str, Given],
    processes: int,
    watcher_of: Callable[[str], Watcher] | None = None,
) -> Iterator[tuple[str, Result | Lost]]:
    """``work(given, watcher)`` of every task, in ``processes`` processes; names and results as they come.

    ``work`` and what it takes and gives must pickle. The messages to its watcher reach
    ``watcher_of(name)`` in this process, if there is one. The processes end with the iteration.
    """
    with closing(Pool(processes)) as pool:
        for name, kind, said in pool.events((name, work, given) for name, given in tasks.items()):
            if kind == ENDED:
                yield name, said
            elif watcher_of is not None:
                getattr(watcher_of(name), kind)(*said)


@contextmanager
def mapper_of(processes: int) -> Iterator[Mapper]:
    """A mapper over ``processes`` processes, which end with the context.

    What a call raises in a worker is raised here, in the place of its result. A worker that is killed raises
    ``ChildProcessError``. 1 process is this one.
    """
    if processes == 1:
        yield serial
        return
    with closing(Pool(processes)) as pool:
        yield lambda function, arguments: _in_order(pool, function, arguments)


def _in_order(
    pool: Pool, function: Callable[..., object], arguments: Iterable[tuple[Any, ...]]
) -> Iterator[Any]:
    calls = ((k, _called, call) for k, call in enumerate(_packed(function, arguments)))
    early: dict[int, Any] = {}
    due = 0
    for k, kind, said in pool.events(calls):
        if kind == ENDED:
            early[k] = said
        while due in early:
            result = early.pop(due)
            if isinstance(result, Lost):
                raise result.error or ChildProcessError(f"{function.__name__}: {result.reason}")
            due += 1
            yield result


_Call = tuple[Callable[..., Any], tuple[Any, ...]]


def _packed(function: Callable[..., object], arguments: Iterable[tuple[Any, ...]]) -> Iterator[_Call]:
    """The calls, each made when it is asked for; what the others share with the first two is pickled once."""
    calls = iter(arguments)
    begun = list(islice(calls, 2))
    shared = [one for one, other in zip(*begun, strict=False) if one is other] if len(begun) > 1 else []
    packed = {id(one): Packed(pickle.dumps(one)) for one in shared}
    for given in chain(begun, calls):
        yield function, tuple(packed.get(id(one), one) for one in given)


def _called(call: _Call, watcher: Watcher) -> Any:
    function, arguments = call
    return function(*(one.unpacked if isinstance(one, Packed) else one for one in arguments))


def load_early(*modules: str) -> None:
    """Begin to import ``modules`` in the process that workers are forked from, in parallel with this one.

    Torch and scipy take seconds. Does nothing where processes cannot be forked.
    """
    ensure_server(*modules)


@dataclass(eq=False)
class _Worker:
    process: Any
    pipe: Connection
    busy: bool = False


class Pool:
    """Workers, at most ``processes`` at a time; started when there is work, kept until ``close``."""

    def __init__(self, processes: int) -> None:
        self._processes = processes
        self._workers: list[_Worker] = []

    def events(self, tasks: Iterable[tuple[Key, Work, Any]]) -> Iterator[tuple[Key, str, Any]]:
        """Do every task ``(key, work, given)``.

        Yields (key, name of a watcher's method, its arguments) for each call in a worker, and at the end of
        each task (key, ENDED, the result or ``Lost``). If the iteration ends early, the tasks are stopped.
        """
        waiting = iter(tasks)
        doing: dict[Any, tuple[_Worker, Key]] = {}
        try:
            while True:
                while len(doing) < self._processes and (task := next(waiting, None)):
                    key, work, given = task
                    worker = self._handed((work, given))
                    if worker is None:
                        yield key, ENDED, Lost("its process was killed as it started")
                        continue
                    doing[worker.pipe] = worker, key
                    yield key, "say", ("begins",)
                if not doing:
                    return
                for pipe in wait(list(doing)):
                    worker, key = doing[pipe]
                    kind, said = self._heard(worker)
                    if kind == ENDED:
                        del doing[pipe]
                    yield key, kind, said
        finally:
            self._end([worker for worker, _ in doing.values()])

    def close(self) -> None:
        """End all processes."""
        self._end(self._workers)

    def _heard(self, worker: _Worker) -> tuple[str, Any]:
        """One message of a busy worker. After the last message of a task the worker is idle or has ended."""
        try:
            kind, said = worker.pipe.recv()
        except (EOFError, OSError):
            worker.process.join()
            self._workers.remove(worker)
            return ENDED, Lost(_how(worker.process.exitcode))
        worker.busy = kind != ENDED
        return kind, said

    def _handed(self, call: tuple[Work, Any]) -> _Worker | None:
        """The worker that took the call: an idle one or a new one; None if the new one was killed as well."""
        for worker in [w for w in self._workers if not w.busy]:
            try:
                worker.pipe.send(call)
            except OSError:
                self._end([worker])
            else:
                worker.busy = True
                return worker
        try:
            worker = _started()
            worker.pipe.send(call)
        except (EOFError, OSError):  # the server that forks it may be gone; the next one starts anew
            return None
        worker.busy = True
        self._workers.append(worker)
        return worker

    def _end(self, workers: Sequence[_Worker]) -> None:
        """Close the pipes, which ends idle workers. Terminate busy ones, and kill those that do not end."""
        for worker in workers:
            worker.pipe.close()
            if worker.busy:
                worker.process.terminate()
        last = time.monotonic() + PATIENCE
        for worker in workers:
            worker.process.join(max(0.0, last - time.monotonic()))
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()
        self._workers = [worker for worker in self._workers if worker not in workers]


def _started() -> _Worker:
    cache_folder()  # if it cannot be used, the user is warned here, and not by every worker
    context: Any = multiprocessing.get_context(METHOD)
    ours, theirs = context.Pipe()
    ensure_server()
    with one_thread():
        process = context.Process(target=serve, args=(theirs, dict(os.environ), importable()))
        process.start()
    theirs.close()
    return _Worker(process, ours)


def _how(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        return f"its process was killed by {signal.Signals(-exitcode).name}"
    return f"its process ended with code {exitcode}"
