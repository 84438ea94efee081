"""The config files as files: where they lie, which options and keys they offer. No Hydra, hence fast.

Enough of Hydra's rules to list names (defaults lists, groups, ``@package _global_``); the values that
a command uses always come from Hydra itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

_GLOBAL = "_global_"
DEFAULT_CASE = "emps"
"""What a command takes where no word chooses a case."""
_WITH_CASE = ("run", "preprocess", "fit", "residual", "validate", "plot", "trace", "sweep", "tune")


def conf_folder() -> Path:
    """The config files: inside the installed package if there, else the repository's ``conf``."""
    here = Path(__file__).resolve().parent
    packaged = here / "conf"
    return packaged if packaged.is_dir() else here.parent / "conf"


def user_folders(words: Sequence[str]) -> list[Path]:
    """The folders that ``--config-dir`` names among a command's words; without a name after it, none."""
    folders = []
    for word, following in zip_longest(words, words[1:], fillvalue=""):
        flag, _, value = word.partition("=")
        if flag in ("--config-dir", "-cd") and (value or following):
            folders.append(Path(value or following))
    return folders


def existing_folders(words: Sequence[str]) -> list[Path]:
    """Those of ``user_folders`` that exist."""
    return [folder for folder in user_folders(words) if folder.is_dir()]


def case_left_out(command: str, words: Sequence[str]) -> str:
    """What to write where ``--config-dir`` adds cases and no word chooses one, so that the command would take
    ``DEFAULT_CASE``; empty where nothing is missing."""
    own = {path.stem for folder in existing_folders(words) for path in (folder / "case").glob("*.yaml")}
    chosen = {word.lstrip("+").partition("=")[0] for word in words}
    if (
        command not in _WITH_CASE
        or not own
        or DEFAULT_CASE in own
        or chosen & {"case", "experiment", "model"}
    ):
        return ""
    return f"no case is chosen: write case={'|'.join(sorted(own))}, or case={DEFAULT_CASE} if that is meant"


def groups(folders: Sequence[Path] = ()) -> list[str]:
    """The config groups, such as ``case`` and ``estimator``."""
    found = {
        p.name
        for root in (*folders, conf_folder())
        for p in root.iterdir()
        if p.is_dir() and any(p.glob("*.yaml"))
    }
    return sorted(found)


def options(group: str, folders: Sequence[Path] = ()) -> list[str]:
    """The choices of a group, the user's own first to be found."""
    return sorted({p.stem for root in (*folders, conf_folder()) for p in (root / group).glob("*.yaml")})


def group_choices(words: Sequence[str], folders: Sequence[Path] = ()) -> dict[str, str]:
    """The option that a command's ``words`` choose in each group, such as ``{"case": "emps"}``."""
    known = groups(folders)
    assigned = [word.partition("=") for word in words if "=" in word]
    return {key: value for key, _, value in assigned if key in known}


def keys(
    command: str, choices: Mapping[str, str] | None = None, folders: Sequence[Path] = ()
) -> dict[str, Any]:
    """Every dotted key of a command's config under the chosen options, with its plain value."""
    roots = (*folders, conf_folder())
    merged: dict[str, Any] = {}
    for package, content in _parts(command, "", dict(choices or {}), roots):
        node = merged
        for name in package:
            node = node.setdefault(name, {})
        _merge(node, content)
    return dict(_flat(merged, ""))


def _parts(
    name: str, group: str, choices: Mapping[str, str], roots: Sequence[Path]
) -> Iterator[tuple[tuple[str, ...], dict[str, Any]]]:
    """The contents that make up config ``name``, in order, each with where it is put."""
    import yaml

    path = next((p for root in roots if (p := root / group / f"{name}.yaml").is_file()), None)
    if path is None:
        return
    text = path.read_text(encoding="utf-8")
    content = yaml.safe_load(text) or {}
    package = () if not group or f"@package {_GLOBAL}" in text.partition("\n")[0] else (group,)
    defaults = content.pop("defaults", ["_self_"])
    content.pop("hydra", None)
    if "_self_" not in defaults:
        defaults = [*defaults, "_self_"]  # as Hydra does: a config wins over its defaults
    for entry in defaults:
        if entry == "_self_":
            yield package, content
        elif isinstance(entry, str):
            yield from _parts(entry, group, choices, roots)
        else:
            below, option = next(iter(entry.items()))
            chosen = choices.get(below, option)
            if not below.startswith("override ") and chosen:
                yield from _parts(str(chosen), below, choices, roots)


def _merge(into: dict[str, Any], content: Mapping[str, Any]) -> None:
    for key, value in content.items():
        if isinstance(value, Mapping) and isinstance(into.get(key), dict):
            _merge(into[key], value)
        else:
            into[key] = dict(value) if isinstance(value, Mapping) else value


def _flat(node: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    for key, value in node.items():
        if isinstance(value, Mapping) and value:
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value
