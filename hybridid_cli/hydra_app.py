"""Hands a command to Hydra: overrides, sweeps, launchers, ``--cfg`` and ``--config-dir`` are Hydra's."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext

from hybridid_cli import interrupt
from hybridid_cli.config_files import conf_folder
from hybridid_cli.main import complain, wants_traceback
from hybridid_cli.words import prepared
from pipelines.shared.secrets import typed

FULL_ERROR = "HYDRA_FULL_ERROR"
SHORT = ("preprocess", "fit", "validate")
"""Commands that end before MLflow is imported, and fork no other processes."""


def run(command: str, words: Sequence[str]) -> int:
    """Carry out a command that has a primary config; returns the exit code."""
    command, words = _fleet(command, typed(words))
    ready = prepared(command, words)
    traceback = wants_traceback() or "--debug" in words
    if command == "sweep":
        _load_early(ready)
    with _mlflow_beside(command, ready):
        return _handed_to_hydra(command, words, ready, traceback)


def _handed_to_hydra(command: str, words: Sequence[str], ready: list[str], traceback: bool) -> int:
    import hydra

    from hybridid_cli.explain import FAILED, explained
    from hybridid_cli.tasks import Unfinished, task_of

    application = hydra.main(config_path=str(conf_folder()), config_name=command, version_base="1.3")
    try:
        with _sys_argv([f"hybridid {command}", *ready]):
            application(task_of(command))()
    except (Exception, Unfinished, SystemExit) as raised:
        interrupt.check()
        if traceback:
            raise
        error = raised.cause if isinstance(raised, Unfinished) else raised
        if isinstance(error, SystemExit):  # hybridid itself never ends the program from inside a command
            return complain(f"some code ended the program before its time, with {error.code!r}", FAILED)
        message, code = explained(error, command, words)
        return complain(message, code)
    return 0


def _fleet(command: str, words: Sequence[str]) -> tuple[str, list[str]]:
    """``trace -m`` as the sweep that it is: a trace at each point, and one table of all."""
    several = {"-m", "--multirun"} & set(words)
    if command != "trace" or not several:
        return command, list(words)
    return "sweep", [*(word for word in words if word not in several), "sweep.stage=trace"]


def _load_early(words: Sequence[str]) -> None:
    """Begin to load what a sweep works with, unless ``words`` only look at its config or name a launcher."""
    if {"-m", "--multirun"} & set(words) and not any("launcher=" in word for word in words):
        from pipelines.shared.pool import load_early

        load_early("pipelines.sweep.work", "hybridid.residuals.training")


def _mlflow_beside(command: str, words: Sequence[str]) -> AbstractContextManager[None]:
    """Imports MLflow beside a command that ends sooner than this import, and logs a run."""
    given = {word.partition("=")[0] for word in words}
    looks = {"--cfg", "-c", "--info", "-i", "-m", "--multirun", "--resolve"} & given
    if command not in SHORT or looks or "mlflow.enabled=false" in words:
        return nullcontext()
    from pipelines.tracking.ahead import imported_beside

    return imported_beside()


@contextmanager
def _sys_argv(words: list[str]) -> Iterator[None]:
    """``words`` in ``sys.argv``, which Hydra reads, in the debugging mode, which lets exceptions pass."""
    argv, full_error = sys.argv, os.environ.get(FULL_ERROR)
    sys.argv, os.environ[FULL_ERROR] = words, "1"
    try:
        yield
    finally:
        sys.argv = argv
        if full_error is None:
            del os.environ[FULL_ERROR]
        else:
            os.environ[FULL_ERROR] = full_error
