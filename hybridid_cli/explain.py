"""Exceptions as one line each: what is wrong, where, what is allowed, the nearest right name."""

from __future__ import annotations

import re
from collections.abc import Sequence

from hydra.errors import (
    ConfigCompositionException,
    HydraException,
    MissingConfigException,
    OverrideParseException,
)
from omegaconf.errors import OmegaConfBaseException

from hybridid_cli.config_files import groups, keys, options, user_folders
from pipelines.shared.errors import ConfigError, Incomplete, unknown

FAILED = 1
WRONG_REQUEST = 2
_MAKERS_HINT = "; --debug shows where"


def explained(error: Exception, command: str, words: Sequence[str]) -> tuple[str, int]:
    """The line to print and the exit code."""
    if isinstance(error, ConfigError):
        return str(error), WRONG_REQUEST
    if isinstance(error, (HydraException, OmegaConfBaseException)):
        return _config_problem(error, command, words), WRONG_REQUEST
    if isinstance(error, (ValueError, Incomplete)):  # RecordError and the like speak for themselves
        return one_line(str(error)), FAILED
    return f"{type(error).__name__}: {one_line(str(error))}{_MAKERS_HINT}", FAILED


def one_line(text: str) -> str:
    """Text without line breaks."""
    return " ".join(text.split())


def _config_problem(error: Exception, command: str, words: Sequence[str]) -> str:
    folders = [folder for folder in user_folders(words) if folder.is_dir()]
    if isinstance(error, MissingConfigException) and error.missing_cfg_file:
        group, _, name = str(error.missing_cfg_file).rpartition("/")
        return unknown(group or "config", name, error.options or options(group, folders))
    if isinstance(error, OverrideParseException):
        return (
            f"cannot read {error.override!r}: write key=value, and quote what the shell would split or change"
        )
    text = str(error)
    if match := re.search(r"Could not (?:override|append to config|delete) '([^']+)'", text):
        return _unknown_key(match[1], command, words)
    if "Ambiguous value for argument" in text and (match := re.search(r"argument '([^']+)'", text)):
        key, _, value = match[1].partition("=")
        return f"{match[1]}: several values; add -m to run each, or write {key}=[{value}] for a list"
    if "requires --multirun" in text:
        return one_line(text).replace("--multirun", "-m")
    cause = error.__cause__ if isinstance(error.__cause__, Exception) else None
    if isinstance(error, ConfigCompositionException) and not text and cause is not None:
        return one_line(str(cause))
    return one_line(f"{text} {cause or ''}")


def _unknown_key(key: str, command: str, words: Sequence[str]) -> str:
    """The nearest key, or group, to one that does not exist; listed are its would-be siblings."""
    folders = [folder for folder in user_folders(words) if folder.is_dir()]
    choices = dict(
        word.split("=", 1) for word in words if "=" in word and word.split("=")[0] in groups(folders)
    )
    known = {*keys(command, choices, folders), *groups(folders)}
    known |= {".".join(k.split(".")[: i + 1]) for k in known for i in range(k.count("."))}
    above = key.rpartition(".")[0]
    while above and above not in known:
        above = above.rpartition(".")[0]
    depth = above.count(".") + 2 if above else 1
    siblings = {".".join(k.split(".")[:depth]) for k in known if not above or k.startswith(f"{above}.")}
    return unknown("config key", key, known, allowed=siblings)
