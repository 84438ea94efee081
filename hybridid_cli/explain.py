"""Exceptions as one line each: what is wrong, where, what is allowed, the nearest right name."""

from __future__ import annotations

import errno
import re
from collections.abc import Sequence
from pathlib import Path

from hydra.errors import (
    ConfigCompositionException,
    HydraException,
    MissingConfigException,
    OverrideParseException,
)
from omegaconf.errors import OmegaConfBaseException
from yaml import YAMLError

from hybridid.naming import shortened
from hybridid_cli.config_files import existing_folders, group_choices, groups, keys, options
from hybridid_cli.exit_codes import FAILED, NOT_CONVERGED, WRONG_MODEL, WRONG_REQUEST
from pipelines.shared.errors import ConfigError, Incomplete, NotConverged, WrongModel, unknown

_MAKERS_HINT = "; --debug shows where"
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
"""Error numbers of a full or broken disk. The error often lacks the name of the file."""


def explained(error: Exception, command: str, words: Sequence[str]) -> tuple[str, int]:
    """The line to print and the exit code."""
    if isinstance(error, ConfigError):
        return str(error), WRONG_REQUEST
    if isinstance(error, (NotConverged, WrongModel)):
        return str(error), NOT_CONVERGED if isinstance(error, NotConverged) else WRONG_MODEL
    if isinstance(error, (HydraException, OmegaConfBaseException)):
        return _config_problem(error, command, words), WRONG_REQUEST
    if "Config group override must be a string or a list" in str(error):
        return _not_an_option(words), WRONG_REQUEST
    if isinstance(error, UnicodeDecodeError):
        return _unreadable(error, words), WRONG_REQUEST
    if isinstance(error, (ValueError, Incomplete)):  # such as RecordError: its message is complete
        return str(error), FAILED
    if isinstance(error, OSError) and (error.filename is not None or error.errno in _NO_ROOM):
        return _file_problem(error), FAILED
    if isinstance(error, MemoryError):
        said = str(error) or "an array does not fit"
        return f"the memory of this machine does not suffice: {said}; make the task smaller", FAILED
    if isinstance(error, YAMLError):
        return _yaml_problem(error), WRONG_REQUEST
    return f"{type(error).__name__}: {error}{_MAKERS_HINT}", FAILED


def _file_problem(error: OSError) -> str:
    """Which file cannot be read or written, and why. If the disk is full, also what became of the results."""
    kept = ""
    if error.errno in _NO_ROOM:
        kept = "; what was unfinished is discarded, what was finished is kept"
    reason = (error.strerror or type(error).__name__).lower()
    where = "writing a file" if error.filename is None else shortened(str(error.filename), 160)
    return f"{where}: {reason}{kept}"


def _yaml_problem(error: YAMLError) -> str:
    """File, line and what is wrong there."""
    mark = getattr(error, "problem_mark", None)
    where = f"{mark.name}, line {mark.line + 1}: " if mark else ""
    return f"{where}{getattr(error, 'problem', None) or error}"


def _unreadable(error: UnicodeDecodeError, words: Sequence[str]) -> str:
    """Which config file is not UTF-8 text."""
    for folder in existing_folders(words):
        for path in sorted(folder.rglob("*.yaml")):
            if path.is_file() and path.read_bytes() == error.object:
                return f"{path}: not UTF-8 text: {error.reason} at byte {error.start}"
    return str(error)


def _config_problem(error: Exception, command: str, words: Sequence[str]) -> str:
    folders = existing_folders(words)
    if isinstance(error, MissingConfigException) and error.missing_cfg_file:
        group, _, name = str(error.missing_cfg_file).rpartition("/")
        known = unknown(group or "config", name, error.options or options(group, folders))
        return f"{known}{_folder_left_out(group, name, folders)}"
    if isinstance(error, OverrideParseException):
        return (
            f"cannot read {error.override!r}: write key=value, and quote what the shell would split or change"
            f"{_twice_quoted(str(error.override))}"
        )
    text = str(error)
    if match := re.search(r"An item is already at '([^']+)'", text):
        return f"{match[1]} is in the config already: write {match[1]}=... without +"
    if match := re.search(r"Could not (?:override|append to config|delete) '([^']+)'", text):
        return _unknown_key(match[1], command, words)
    if "Ambiguous value for argument" in text and (match := re.search(r"argument '([^']+)'", text)):
        key, _, value = match[1].partition("=")
        return f"{match[1]}: several values; add -m to run each, or write {key}=[{value}] for a list"
    if "requires --multirun" in text:
        return text.replace("--multirun", "-m")
    cause = error.__cause__ if isinstance(error.__cause__, Exception) else None
    if isinstance(error, ConfigCompositionException) and not text and cause is not None:
        return str(cause)
    return _plain(f"{text} {cause or ''}")


def _twice_quoted(word: str) -> str:
    """How to write a value with signs that Hydra does not take, as ``unit=N·m``."""
    key, _, value = word.partition("=")
    special = re.search(r"[^\w\s.,:/*+-]", value) and not re.search(r"[\[\]{}()'\"]", value)
    return f"; special signs need quotes inside the shell's: '{key}=\"{value}\"'" if key and special else ""


def _folder_left_out(group: str, name: str, folders: Sequence[Path]) -> str:
    """A hint at the folder here, or in here, that holds the config which ``--config-dir`` would add; without
    one, and where no folder was named, that a case of one's own needs it."""
    if not (group and name):
        return ""
    here = (Path(), *sorted(Path().iterdir()))
    if folder := next((one for one in here if (one / group / f"{name}.yaml").is_file()), None):
        return f"; {folder / group / name}.yaml is there: add --config-dir {folder}"
    return "; a case of your own needs --config-dir FOLDER" if group == "case" and not folders else ""


def _plain(text: str) -> str:
    """A message of OmegaConf without the names of its own classes, the key first."""
    text = re.sub(r"\s*(object_type=\w*|reference_type=\S*)", "", text)
    key = re.search(r"\s*full_key: *(\S*)", text)
    text = re.sub(r"\s*full_key: *\S*", "", text)
    text = re.sub(r"\w+ raised while (composing config|resolving interpolation): *", "", text)
    return f"{key[1]}: {text}" if key and key[1] else text


def _not_an_option(words: Sequence[str]) -> str:
    """Which config group has a number or null as its value. It needs the name of one of its files."""
    folders = existing_folders(words)
    for word in words:
        key, _, value = word.lstrip("+").partition("=")
        if key in groups(folders) and value not in options(key, folders):
            return unknown(key, value, options(key, folders))
    return "a config group needs a name, as in estimator=gauss_newton"


def _unknown_key(key: str, command: str, words: Sequence[str]) -> str:
    """The existing key or group that is nearest to the unknown ``key``, and the keys of the same section."""
    folders = existing_folders(words)
    top = key.partition(".")[0]
    known = {*keys(command, group_choices(words, folders), folders), *groups(folders)}
    if top in groups(folders) and not any(one.startswith(f"{top}.") for one in known):
        return f"{key}: no {top} is chosen in this config; choose {top}={'|'.join(options(top, folders))}"
    known |= {".".join(k.split(".")[: i + 1]) for k in known for i in range(k.count("."))}
    above = key.rpartition(".")[0]
    while above and above not in known:
        above = above.rpartition(".")[0]
    depth = above.count(".") + 2 if above else 1
    siblings = {".".join(k.split(".")[:depth]) for k in known if not above or k.startswith(f"{above}.")}
    return unknown("config key", key, sorted(known), allowed=sorted(siblings))
