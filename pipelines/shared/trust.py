"""Which code may run that a file names: the user's own, and that of folders that the user trusts.

A model.json names its plant and effects by import path, and the folders in which they lie. Whoever wrote the
file chose both. So it never makes code run by itself: the code must be part of hybridid, or named by the user
(in the config or by ``--config-dir``), or lie in a folder that the user trusts. Trust is remembered by the
digest of all code in the folder, so it ends when a file changes.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hybridid.private import content_of_own, exposed
from pipelines.shared.errors import ConfigError
from pipelines.shared.own_code import (
    check_comes_from,
    digest_of_code,
    folder_with,
    importable,
    make_importable,
)


class Untrusted(ConfigError):
    """Raised for a file that names code in a ``folder`` which the user does not trust."""

    def __init__(self, what: str, path: str, folder: Path) -> None:
        name = printable(folder)
        super().__init__(
            f"{what} names {printable(path)}, code in {name}, which you do not trust{_why_not_read()}; "
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
    return not _why_not_read() and content_of_own(store() / digest_of_code(folder)) is not None


def trust(folder: Path) -> Trusted:
    """Remember the code in a folder as trusted.

    Raises:
        ConfigError: if there is no such folder, no code in it, or it cannot be remembered safely.
    """
    if not folder.is_dir():
        raise ConfigError(f"{folder}: no such folder")
    digest, place = digest_of_code(folder), store()
    try:
        place.mkdir(parents=True, exist_ok=True, mode=0o700)
        if reason := exposed(place):
            raise ConfigError(f"{folder} cannot be remembered as trusted: {reason}")
        new = place / f".{os.getpid()}"
        with os.fdopen(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as stream:
            stream.write(f"{folder.resolve()}\n")
        new.replace(place / digest)
    except OSError as error:
        raise ConfigError(f"{folder} cannot be remembered as trusted: {place}: {error.strerror}") from error
    return Trusted(str(folder.resolve()), digest)


def all_trusted() -> list[Trusted]:
    """What the user trusts, by folder.

    Raises:
        ConfigError: if others could have changed it.
    """
    if reason := _why_not_read():
        raise ConfigError(f"nothing is trusted{reason}")
    files = [file for file in store().glob("[!.]*") if content_of_own(file) is not None]
    return sorted((Trusted(file.read_text().strip(), file.name) for file in files), key=lambda t: t.folder)


def store() -> Path:
    """Where trust is remembered: a file for each digest, with the name of the folder."""
    config = os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config"
    return Path(config) / "hybridid" / "trusted"


def printable(text: object) -> str:
    """What a received file says, without characters that would steer a terminal."""
    return "".join(c if c.isprintable() else "?" for c in str(text))


_admitted: set[Path] = set()


def _named() -> list[Path]:
    """The folders that the user named in this process."""
    return [folder for folder in importable() if folder not in _admitted]


def _why_not_read() -> str:
    """Why what was remembered is not believed, as the end of a sentence; empty if it is."""
    place = store()
    reason = exposed(place) if place.is_dir() else ""
    return f" (what you trusted is not read: {reason})" if reason else ""
