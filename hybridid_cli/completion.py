"""Completion of commands, cases, config keys and groups, effects and flags. Light: never Hydra."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from hybridid_cli.commands import BY_NAME
from hybridid_cli.config_files import existing_folders, group_choices, groups, keys, options
from hybridid_cli.words import CFG, FLAGS
from pipelines.shared.errors import ConfigError, unknown

# Bash breaks words at = : @ too, and replaces only what follows the last break.
BASH = r"""
_hybridid_complete() {
    local line=${COMP_LINE:0:COMP_POINT} IFS=$'\n' whole kept
    whole=${line##*[[:space:]]}
    kept=${whole%"${whole##*[=:@]}"}
    COMPREPLY=($("${COMP_WORDS[0]}" completion words "$line" 2>/dev/null))
    COMPREPLY=("${COMPREPLY[@]#"$kept"}")
    if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=./] || ${COMPREPLY[0]} == *'['* ]]; then
        compopt -o nospace
    fi
    if [[ ${#COMPREPLY[@]} -eq 0 ]]; then
        compopt -o default
    fi
}
complete -F _hybridid_complete hybridid
""".strip()

_SETTINGS = ("guess", "lower", "upper", "fixed", "by")


def command(name: str, words: Sequence[str]) -> int:
    """``hybridid completion bash`` prints the script; ``completion words LINE`` what may come next."""
    if list(words) == ["bash"]:
        print(BASH)
        return 0
    if len(words) == 2 and words[0] == "words":
        print("\n".join(candidates(words[1])))
        return 0
    raise ConfigError(unknown("shell", words[0] if words else "", ["bash"]))


def candidates(line: str) -> list[str]:
    """The words that may stand at the end of ``line`` instead of its last, unfinished one."""
    *before, current = line.split() if line[-1:].strip() else [*line.split(), ""]
    return sorted({word for word in _offered(before[1:], current) if word.startswith(current)})


def _offered(before: Sequence[str], current: str) -> Iterator[str]:
    if not before:
        yield from [*BY_NAME, "--help", "--version"]
        return
    name, words = before[0], list(before[1:])
    folders = existing_folders(words)
    if words and words[-1] in ("--cfg", "-c"):
        yield from CFG
    elif words and words[-1] in ("--config-dir", "-cd"):
        yield from _folders(current)
    elif name == "completion":
        yield "bash"
    elif name == "new":
        yield from _of_new(words)
    elif name == "effects":
        yield from _effects()
    elif name in ("cases", "fetch") and "=" not in current:
        yield from options("case", folders)
    elif name in BY_NAME and BY_NAME[name].configured:
        yield from _overrides(name, words, current, folders)
    if current.startswith("-"):
        yield from [*(flag for flag in FLAGS if flag.startswith("--") or flag == "-m"), "--help"]


_VALUED = ("--from", "--signal", "--scale", "--hold", "--constant", "--time", "--time-unit", "--rate")


def _of_new(words: Sequence[str]) -> Iterator[str]:
    """The flags of ``new``, and the templates after ``--template``."""
    if words and words[-1] == "--template":
        from pipelines.new.template import kinds

        yield from kinds()
    elif not words or words[-1] not in _VALUED:  # after --from the shell completes files
        yield from (*_VALUED, "--template")


def _overrides(name: str, words: Sequence[str], current: str, folders: Sequence[Path]) -> Iterator[str]:
    """Keys up to the next dot, then values where they are known."""
    known_groups = groups(folders)
    choices = group_choices(words, folders)
    key, assigned, value = current.partition("=")
    if not assigned:
        for known in [*keys(name, choices, folders), *_parameter_keys(name, choices, folders)]:
            below = known[len(current) :].partition(".") if known.startswith(current) else ("", "", "")
            yield known[: len(current)] + below[0] + "." if below[1] else f"{known}="
        yield from (f"{group}=" for group in known_groups)
    elif key in known_groups:
        yield from (f"{key}={option}" for option in options(key, folders))
    elif key in ("effects", "trace.effects"):
        yield from _effect_lists(key, value)
    else:
        from hybridid_cli import keys as declared  # not needed for names

        yield from (f"{key}={choice}" for choice in declared.choices().get(key, ()))


def _parameter_keys(name: str, choices: dict[str, str], folders: Sequence[Path]) -> Iterator[str]:
    """Every setting of the parameters that the case adjusts."""
    for key in keys(name, choices, folders):
        if key.startswith("parameters.") and key.rpartition(".")[2] in _SETTINGS:
            yield from (f"{key.rpartition('.')[0]}.{setting}" for setting in _SETTINGS)


def _effect_lists(key: str, value: str) -> Iterator[str]:
    """``[viscous,cou`` -> ``[viscous,coulomb``: the list so far with each effect that is not in it."""
    done, comma, _ = value.rpartition(",")
    taken = done.strip("[").split(",")
    yield from (
        f"{key}={done + comma if comma else '['}{effect}" for effect in _effects() if effect not in taken
    )


def _effects() -> list[str]:
    from hybridid.effects.library import EFFECTS

    return [effect.id for effect in EFFECTS]


def _folders(current: str) -> Iterator[str]:
    above = Path(current) if current.endswith("/") else Path(current).parent
    prefix = "" if above == Path() and not current.startswith(".") else f"{above}/".replace("//", "/")
    yield from (f"{prefix}{p.name}/" for p in above.iterdir() if p.is_dir()) if above.is_dir() else ()
