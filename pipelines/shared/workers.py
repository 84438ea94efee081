"""Refits side by side: a pool of processes, each with one thread."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from hybridid.trace.mapper import Mapper, serial


@contextmanager
def workers(processes: int) -> Iterator[Mapper]:
    """A mapper over ``processes`` processes; they are gone when the context ends, however it ends."""
    if processes == 1:
        yield serial
        return
    from joblib.externals.loky import get_reusable_executor

    try:
        yield lambda function, arguments: _mapped(processes, function, arguments)
    finally:
        get_reusable_executor(reuse=True).shutdown(wait=True, kill_workers=True)


def _mapped(
    processes: int, function: Callable[..., object], arguments: Iterable[tuple[Any, ...]]
) -> Iterable[Any]:
    """Results in the order of ``arguments``, as they come.

    One thread in each process: the pool already fills the machine.
    """
    from joblib import Parallel, delayed, parallel_config

    with parallel_config(backend="loky", n_jobs=processes, inner_max_num_threads=1):
        pool = Parallel(return_as="generator", batch_size=1, pre_dispatch="all")
        yield from pool(delayed(function)(*given) for given in arguments)
