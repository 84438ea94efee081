"""Which code may run that a file names: the user's own, and that of folders that the user trusts.

A model.json names its plant and effects by import path, and the folders in which they lie. Whoever wrote the
file chose both. So it never makes code run by itself: the code must be part of hybridid, or named by the user
(in the config or by ``--config-dir``), or lie in a folder that the user trusts. Trust is remembered by the
digest of all code in the folder, so it ends when a file changes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipelines.shared.errors import ConfigError
from pipelines.shared.own_code import (
    check_comes_from,
    digest_of_code,
    folder_with,
    importable,
    make_importable,
)
from pipelines.shared.remembered import all_remembered, is_remembered, not_believed, remember

TRUSTED = "trusted"
"""The kind under which it is remembered."""


class Untrusted(ConfigError):
    """Raised for a file that names code in a ``folder`` which the user does not trust."""

    def __init__(self, what: str, path: str, folder: Path) -> None:
        name, reason = printable(folder), not_believed(TRUSTED)
        why = f" (what you agreed to is not read: {reason})" if reason else ""
        super().__init__(
            f"{what} names {printable(path)}, code in {name}, which you do not trust{why}; "
            f"if you have read it and want it to run: hybridid trust {name}"
        )
        self.what, self.folder = what, folder


@dataclass(frozen=True)
class Trusted:
    """A ``folder`` as it was when the user trusted it, by the ``digest`` of its code."""

    folder: str
    digest: str


def admit(what: str, paths: Iterable[str], folders: Sequence[Path], own: Iterable[str] = ()) -> None:
    """Make the code importable that a file names, if it may run.

    ``what`` is the file in words. ``paths`` are the import paths in it, ``folders`` those in which it says
    that they lie. ``own`` are import paths that the user's own config names.

    Raises:
        Untrusted: if the user has to trust a folder first.
        ConfigError: if it names code that is nowhere in its folders.
    """
    users = {path.partition(":")[0] for path in own}
    folders = [folder.resolve() for folder in folders]
    for path in paths:
        module = path.partition(":")[0]
        folder = folder_with(module, folders)
        ours = module.partition(".")[0] == "hybridid" or module in users
        if ours or folder_with(module, importable() if folder is None else _named()):
            continue
        if folder is None:
            raise ConfigError(
                f"{what} names {printable(path)}, which is neither hybridid's nor in a folder that the file "
                f"gives; if you know it: --config-dir FOLDER names the folder where it lies"
            )
        if not is_trusted(folder):
            raise Untrusted(what, path, folder)
        make_importable([folder])
        _admitted.add(folder)
        check_comes_from(folder, module, what)


def paths_in(config: Mapping[str, Any]) -> list[str]:
    """The import paths in a config: its plant, its rig, its effects and those that a trace tries."""
    trace, rig = config.get("trace") or {}, config.get("rig") or {}
    effects = [config.get("effects"), trace.get("effects"), trace.get("extra_effects")]
    entries = [str(entry) for some in effects if isinstance(some, list | tuple) for entry in some]
    modules = [config.get("plant"), rig.get("path"), *(e.partition("@")[0] for e in entries if ":" in e)]
    return [str(path) for path in modules if path]


def is_trusted(folder: Path) -> bool:
    """Whether the user trusts the code in a folder as it is now."""
    return is_remembered(TRUSTED, digest_of_code(folder))


def trust(folder: Path) -> Trusted:
    """Remember the code in a folder as trusted.

    Raises:
        ConfigError: if there is no such folder, too much code in it, or it cannot be remembered safely.
    """
    if not folder.is_dir():
        raise ConfigError(f"{folder}: no such folder")
    given = Trusted(str(folder.resolve()), digest_of_code(folder))
    remember(TRUSTED, given.digest, given.folder)
    return given


def all_trusted() -> list[Trusted]:
    """What the user trusts, by folder.

    Raises:
        ConfigError: if others could have changed it.
    """
    return sorted((Trusted(text, digest) for digest, text in all_remembered(TRUSTED).items()), key=str)


def printable(text: object) -> str:
    """Text from a received file without control characters, which a terminal would execute."""
    return "".join(c if c.isprintable() else "?" for c in str(text))


_admitted: set[Path] = set()


def _named() -> list[Path]:
    """The folders that the user named in this process."""
    return [folder for folder in importable() if folder not in _admitted]
