"""Time limits for MLflow, all in s. Results are written to disk first, so that a command need not wait long.

The user sets how long a server may take for one run: ``mlflow.patience``.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager

PAUSE = 60.0
"""A store that was too slow is not used again for this time. Otherwise a sweep would wait at every point."""
ANSWER = 5.0
"""A server that does not answer within this time counts as down."""
QUEUE = 120.0
"""The wait for other processes that write to the sqlite file, which allows one writer at a time."""
END = 5.0
"""The wait for the end of the server of ``hybridid ui``."""
REQUESTS = {
    "MLFLOW_HTTP_REQUEST_MAX_RETRIES": "1",
    "MLFLOW_HTTP_REQUEST_TIMEOUT": "10",
    "MLFLOW_HTTP_REQUEST_BACKOFF_FACTOR": "1",
    "MLFLOW_ARTIFACT_UPLOAD_DOWNLOAD_TIMEOUT": "30",
}
"""MLflow's own settings; its defaults wait minutes for a server that is down. A user's values come first."""
_paused: dict[str, float] = {}


class Slow(RuntimeError):
    """The store took longer than its time limit."""


def clock(patience: float | None) -> Callable[[], None]:
    """Raises ``Slow`` when it is called later than ``patience`` seconds from now (None: never)."""
    end = None if patience is None else time.monotonic() + patience

    def in_time() -> None:
        if end is not None and time.monotonic() > end:
            raise Slow(f"it took more than {patience:g} s (mlflow.patience)")

    return in_time


def pause(uri: str) -> None:
    """Note that the store at ``uri`` was too slow."""
    _paused[uri] = time.monotonic() + PAUSE


def paused(uri: str) -> bool:
    """Whether the store at ``uri`` was too slow within the last ``PAUSE`` seconds."""
    return time.monotonic() < _paused.get(uri, 0.0)


@contextmanager
def in_background() -> Iterator[Callable[..., None]]:
    """Yields a function that makes calls in order in another thread: the jobs do not wait for MLflow."""
    with ThreadPoolExecutor(1, "mlflow") as thread:
        begun: list[Future[None]] = []
        try:
            yield lambda task, *given: begun.append(thread.submit(task, *given))
        except BaseException:
            thread.shutdown(cancel_futures=True)
            raise
        for one in begun:
            one.result()
