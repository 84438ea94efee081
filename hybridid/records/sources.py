"""Where recordings are found, and the hash of their content."""

from __future__ import annotations

import difflib
import hashlib
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from hybridid.naming import shortened
from hybridid.records.channel import RecordError

DATA_VARIABLE = "HYBRIDID_DATA"
DEFAULT_ROOT = Path("data/raw")


class RecordNotFoundError(RecordError):
    """Raised if a recording is not found: a case may use its virtual rig instead."""


@dataclass(frozen=True)
class DataRoot:
    """A folder in which recordings are searched, and the setting that named it."""

    path: Path
    named_by: str = ""

    def __str__(self) -> str:
        return f"{self.path} ({self.named_by})" if self.named_by else str(self.path)


def data_roots(
    override: str | Path | None = None,
    environment: Mapping[str, str] = os.environ,
    default: Path = DEFAULT_ROOT,
) -> tuple[DataRoot, ...]:
    """The folders to search, in this order: ``paths.data``, ``$HYBRIDID_DATA``, ``data/raw``."""
    found = []
    if override:
        found.append(DataRoot(Path(override).expanduser(), "paths.data"))
    if environment.get(DATA_VARIABLE):
        found.append(DataRoot(Path(environment[DATA_VARIABLE]).expanduser(), f"${DATA_VARIABLE}"))
    return (*found, DataRoot(default))


def locate(relative_path: str | Path, roots: Sequence[DataRoot | Path | str]) -> Path:
    """``relative_path`` under the first of ``roots`` that holds it; an absolute path is returned as it is.

    Raises:
        RecordNotFoundError: in one line, with the folders searched and a file there with a similar name.
    """
    relative_path = Path(relative_path).expanduser()
    if relative_path.is_absolute():
        if _is_file(relative_path):
            return relative_path
        raise RecordNotFoundError(
            f"{shortened(str(relative_path), 120)}: no such file{_namesake([relative_path])}"
        )
    named = [root if isinstance(root, DataRoot) else DataRoot(Path(root)) for root in roots]
    candidates = [root.path / relative_path for root in named]
    for candidate in candidates:
        if _is_file(candidate):
            return candidate
    looked = ", ".join(map(str, named)) or "nowhere: no data root is set"
    raise RecordNotFoundError(
        f"{shortened(str(relative_path), 120)} not found{_namesake(candidates)}; looked under {looked}; "
        f"set paths.data or ${DATA_VARIABLE} to the folder that holds it"
    )


def _is_file(path: Path) -> bool:
    """Whether there is such a file; a name that no file can have is none."""
    try:
        return path.is_file()
    except (OSError, ValueError):  # too long, or with a zero byte
        return False


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def _namesake(candidates: Iterable[Path]) -> str:
    """``, did you mean X?`` if a folder that was searched holds a file with a similar name."""
    for candidate in candidates:
        if _is_folder(candidate.parent):
            there = {file.name.lower(): file for file in candidate.parent.iterdir() if file.is_file()}
            near = difflib.get_close_matches(candidate.name.lower(), there, n=1, cutoff=0.6)
            if near:
                return f", did you mean {there[near[0]]}?"
    return ""


def digest_of(files: Sequence[Path]) -> str:
    """SHA-256 in hexadecimal: of the file if there is one, of the sorted digests if there are several."""
    digests = sorted(_sha256(file) for file in files)
    return digests[0] if len(digests) == 1 else hashlib.sha256("\n".join(digests).encode()).hexdigest()


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
