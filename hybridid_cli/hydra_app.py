"""Runs a command with Hydra, which handles overrides, sweeps, launchers, ``--cfg`` and ``--config-dir``."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext

from hybridid_cli import interrupt
from hybridid_cli.config_files import case_left_out, conf_folder
from hybridid_cli.exit_codes import FAILED
from hybridid_cli.main import complain, wants_traceback
from hybridid_cli.words import LOOKS, MULTIRUN, has_multirun, prepared
from pipelines.shared.secrets import typed

FULL_ERROR = "HYDRA_FULL_ERROR"
SHORT = ("preprocess", "fit", "validate")
"""Commands that take less time than the import of MLflow, and fork no other processes."""


def run(command: str, words: Sequence[str]) -> int:
    """Carry out a command that has a primary config; returns the exit code."""
    command, words = _fleet(command, typed(words))
    if missing := case_left_out(command, words):
        return complain(missing)
    ready = prepared(command, words)
    traceback = wants_traceback() or "--debug" in words
    if command == "sweep":
        _load_early(ready)
    with _mlflow_beside(command, ready):
        return _handed_to_hydra(command, words, ready, traceback)


def _handed_to_hydra(command: str, words: Sequence[str], ready: list[str], traceback: bool) -> int:
    import hydra

    from hybridid_cli.explain import explained
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
            return complain(f"some code called sys.exit with {error.code!r}", FAILED)
        message, code = explained(error, command, words)
        return complain(message, code)
    return 0


def _fleet(command: str, words: Sequence[str]) -> tuple[str, list[str]]:
    """Turn ``trace -m`` into the equal sweep: a trace at each point, and one table of all."""
    if command != "trace" or not has_multirun(words):
        return command, list(words)
    return "sweep", [*(word for word in words if word not in MULTIRUN), "sweep.stage=trace"]


def _load_early(words: Sequence[str]) -> None:
    """Start to import the modules of a sweep, unless ``words`` only print its config or name a launcher."""
    if has_multirun(words) and not any("launcher=" in word for word in words):
        from pipelines.shared.pool import load_early

        load_early("pipelines.sweep.work", "hybridid.residuals.training")


def _mlflow_beside(command: str, words: Sequence[str]) -> AbstractContextManager[None]:
    """Import MLflow in parallel with a short command that logs a run: the import takes longer than it."""
    given = {word.partition("=")[0] for word in words}
    if command not in SHORT or given & {*LOOKS, *MULTIRUN, "--resolve"} or "mlflow.enabled=false" in words:
        return nullcontext()
    from pipelines.tracking.ahead import imported_beside

    return imported_beside()


@contextmanager
def _sys_argv(words: list[str]) -> Iterator[None]:
    """Set ``sys.argv``, which Hydra reads, to ``words``, and Hydra's debugging mode, in which it passes
    exceptions on."""
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
