"""``PublicArchive``: the address of a public record and the hashes of its files."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from urllib.parse import urlsplit

SHA256 = re.compile(r"[0-9a-f]{64}")


class FetchError(ValueError):
    """Raised if a public record cannot be fetched: the message says why and which page to visit."""


@dataclass(frozen=True)
class PublicArchive:
    """A zip archive on the web.

    ``members`` maps the wanted files, as relative paths, to their SHA-256; in the archive they
    may lie in a subfolder. Neither the archive nor one of them has more than ``most`` bytes.
    ``sha256`` is that of the archive, if known. ``page`` is the page from which
    a person can download it by hand.

    Raises:
        FetchError: if a member's path leaves its folder, or a hash or the address is not valid.
    """

    name: str
    url: str
    page: str
    members: Mapping[str, str]
    sha256: str | None = None
    licence: str = ""
    citation: str = ""
    most: int = 1 << 28

    def __post_init__(self) -> None:
        if not _is_address(self.url):
            raise FetchError(f"archive {self.name}: {self.url!r} is no http or https address")
        for member in self.members:
            if not is_safe(member):
                raise FetchError(f"archive {self.name}: member {member!r} is no path inside a folder")
        for digest in filter(None, (*self.members.values(), self.sha256)):
            if not SHA256.fullmatch(digest):
                raise FetchError(f"archive {self.name}: {digest!r} is no SHA-256 in hexadecimal")

    def by_hand(self, folder: Path) -> str:
        """A sentence that says how to download the files into ``folder`` by hand."""
        return f"download it from {self.page} by hand and put {', '.join(self.members)} into {folder}"


def _is_address(url: str) -> bool:
    try:
        parts = urlsplit(url)
        return parts.scheme in ("http", "https") and bool(parts.hostname)
    except ValueError:  # brackets that are no IPv6 address
        return False


def is_safe(path: str) -> bool:
    """Whether ``path``, with forward slashes, stays inside the folder it is joined to."""
    parts = PurePosixPath(path).parts
    return bool(parts) and parts[0] != "/" and not {"..", "."} & set(parts) and not set("\\:\0") & set(path)


def sha256_of(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
