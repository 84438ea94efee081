"""The words after the command, made ready for Hydra: flags and bare words are checked here."""

from __future__ import annotations

import re
from collections.abc import Sequence

from hybridid.naming import shortened
from hybridid_cli.config_files import options, user_folders
from pipelines.shared.errors import ConfigError, unknown

MULTIRUN = ("-m", "--multirun")
LOOKS = ("--cfg", "-c", "--info", "-i")
"""Flags that print the config, and run nothing."""
SWITCHES = (*MULTIRUN, "--resolve", "--debug", "-r", "--run")
WITH_VALUE = ("--config-dir", "-cd", "--package", "-p", *LOOKS)
FLAGS = (*SWITCHES, *WITH_VALUE)
MAY_BE_NEW = ("parameters", "channels", "rig", "archive")
"""Keys that a command line may give though the case's file does not."""
_OF_RECORDS = re.compile(
    r"signals\.(resample|simulated)|records\.[^.]+\.(resample|steps|simulated)|"
    r"(signals|records\.[^.]+)\.outputs\.[^.]+\.missing"
)
"""The same below keys whose others the case's file must give."""
CFG = ("job", "hydra", "all")


def prepared(command: str, words: Sequence[str]) -> list[str]:
    """``words`` as Hydra takes them: flags first, ``MAY_BE_NEW`` allowed to be new keys.

    Raises:
        ConfigError: for an unknown flag or a word that is no override.
    """
    flags: list[str] = []
    overrides: list[str] = []
    value_of = ""
    for word in words:
        if value_of:
            _check_flag_value(value_of, word)
            flags.append(word)
            value_of = ""
        elif word.startswith("-"):
            flags.append(word)
            value_of = _flag_awaiting_value(word)
        else:
            overrides.append(_override(command, word, words))
    if value_of:
        raise ConfigError(f"{value_of} wants a value after it")
    flags = [flag for flag in flags if flag != "--debug"]
    if command == "sweep":  # always over several points; it chooses its own folders
        given = {flag.partition("=")[0] for flag in flags}
        several = [] if given & {*LOOKS, *MULTIRUN} else ["-m"]
        return [*several, *flags, *overrides]
    return [*flags, *overrides, *_sweep_folder(flags, overrides)]


def has_multirun(words: Sequence[str]) -> bool:
    """Whether ``words`` ask for several points, by ``-m``."""
    return any(word in MULTIRUN for word in words)


def _flag_awaiting_value(word: str) -> str:
    """The flag, if its value is the next word; empty if not."""
    flag, has_value, value = word.partition("=")
    if flag not in FLAGS:
        raise ConfigError(unknown("flag", flag, FLAGS))
    if has_value:
        _check_flag_value(flag, value)
    return flag if flag in WITH_VALUE and not has_value else ""


def _override(command: str, word: str, words: Sequence[str]) -> str:
    if "=" not in word and not word.startswith("~"):
        return _bare(command, word, words)
    key = word.partition("=")[0]
    new = key.partition(".")[0] in MAY_BE_NEW or _OF_RECORDS.match(key)
    return f"++{word}" if new else word


def _check_flag_value(flag: str, value: str) -> None:
    if flag in ("--cfg", "-c") and value not in CFG:
        raise ConfigError(unknown("value of --cfg", value, CFG))


def _bare(command: str, word: str, words: Sequence[str]) -> str:
    cases, said = options("case", user_folders(words)), shortened(repr(word), 80)
    if command == "fetch" and "," not in word:
        return f"case={word}"
    if word in cases:
        raise ConfigError(f"{said} is no key=value; did you mean case={word}?")
    raise ConfigError(f"{said} is no key=value, as in case=emps or estimator.horizon=1000")


def _sweep_folder(flags: Sequence[str], overrides: Sequence[str]) -> list[str]:
    """With ``-m out=DIR`` Hydra's own files of the sweep go to DIR too."""
    if not has_multirun(flags) or any(w.startswith("hydra.sweep.dir=") for w in overrides):
        return []
    return [f"hydra.sweep.dir={w.removeprefix('out=')}" for w in overrides if w.startswith("out=")][-1:]
