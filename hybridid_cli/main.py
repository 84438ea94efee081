"""The entry point: finds the command and calls its module. Help and unknown commands import nothing else."""

from __future__ import annotations

import gc
import importlib
import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from hybridid.naming import shortened
from hybridid_cli import helptexts, interrupt
from hybridid_cli.commands import BY_NAME, COMMANDS
from hybridid_cli.exit_codes import WRONG_REQUEST
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.secrets import mask_streams

LONGEST = 700


def main() -> None:
    """Run the command on ``sys.argv`` and exit with its code."""
    # no process of ours imports modules from the current folder: its files may come from somebody else
    os.environ["PYTHONSAFEPATH"] = "1"
    try:
        interrupt.install()  # a signal may come before the next line
        warnings.showwarning = _show_warning
        mask_streams()
        code = dispatch(sys.argv[1:])
        sys.stdout.flush()
        interrupt.ignore_from_now()
    except KeyboardInterrupt as raised:
        interrupt.ignore_from_now()
        asked = interrupt.last()
        code = asked.code
        with _terminal_may_be_gone():
            kept = "what was unfinished is discarded, the rest is kept: the same command goes on"
            complain("; ".join([str(asked), kept, *getattr(raised, "__notes__", ())]))
    except BrokenPipeError:  # `hybridid effects | head`
        _silence(sys.stdout)
        code = 0
    gc.freeze()  # saves a last garbage collection over all modules: 0.2 s, with MLflow 0.9 s
    sys.exit(code)


@contextmanager
def _terminal_may_be_gone() -> Iterator[None]:
    """Ignore errors of writing: after SIGHUP the terminal may be closed. The exit code stays the same."""
    try:
        yield
        sys.stdout.flush()
    except OSError:
        _silence(sys.stdout)
        _silence(sys.stderr)


def _silence(stream: TextIO) -> None:
    """Discard what Python still writes to the stream while it exits."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def dispatch(words: Sequence[str]) -> int:
    """Carry out ``words`` and return the exit code: 0, 1 (failed), 2 (wrong request), 3 (the fit has not
    converged) or 4 (the fitted model is wrong)."""
    if not words or words[0] in ("-h", "--help"):
        print(helptexts.overview([(c.name, c.summary) for c in COMMANDS]))
        return 0
    if words[0] == "--version":
        from hybridid import __version__

        print(f"hybridid {__version__}")
        return 0
    if words[0] == "help":
        return dispatch([*words[1:2], "--help"])
    if words[0] not in BY_NAME:
        return complain(_not_a_command(words[0]))
    command = BY_NAME[words[0]]
    if any(word in ("-h", "--help") for word in words[1:]):
        print(helptexts.of_command(command.name, command.summary, command.details, command.configured))
        return 0
    module, _, function = command.handler.partition(":")
    try:
        return int(getattr(importlib.import_module(module), function)(command.name, list(words[1:])))
    except ConfigError as error:
        interrupt.check()
        if wants_traceback():
            raise
        return complain(str(error))
    except Exception as error:
        interrupt.check()  # a signal may have struck a library that reports something else instead
        if wants_traceback() or isinstance(error, BrokenPipeError):
            raise
        from hybridid_cli.explain import explained  # imports Hydra, which takes a while

        return complain(*explained(error, command.name, words[1:]))


def complain(message: str, code: int = WRONG_REQUEST) -> int:
    """Say in one line of at most ``LONGEST`` characters what is wrong; returns ``code``."""
    print(f"hybridid: {shortened(message, LONGEST)}", file=sys.stderr)
    return code


def wants_traceback() -> bool:
    """Whether the user asked for the traceback of an error."""
    return os.environ.get("HYDRA_FULL_ERROR") == "1"


def _show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """Print a warning of hybridid in one line without its place in the code, others as Python prints them."""
    own = Path(filename).is_relative_to(Path(__file__).parents[1] / "hybridid")
    text = f"hybridid: warning: {message}\n"
    (file or sys.stderr).write(text if own else warnings.formatwarning(message, category, filename, lineno))


def _not_a_command(word: str) -> str:
    if word.startswith("-") or "=" in word:
        return f"a command comes first, then {word}: hybridid <command> {word}; see hybridid --help"
    return unknown("command", word, BY_NAME)
