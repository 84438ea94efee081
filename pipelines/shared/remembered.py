"""What the user has agreed to, stored for later commands: a file for each item, named by its digest.

The files lie in ``$XDG_CONFIG_HOME/hybridid`` (by default in ``~/.config``), which only the user may change.
If other users can write there, no file in it is used.
"""

from __future__ import annotations

import os
from pathlib import Path

from hybridid.private import content_of_own, exposed
from pipelines.shared.errors import ConfigError


def place_of(kind: str) -> Path:
    """The folder of one kind, such as ``trusted``."""
    config = os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config"
    return Path(config) / "hybridid" / kind


def is_remembered(kind: str, digest: str) -> bool:
    """Whether the user agreed to what has this digest."""
    return not not_believed(kind) and content_of_own(place_of(kind) / digest) is not None


def remember(kind: str, digest: str, text: str) -> None:
    """Store the ``digest`` of what the user agreed to, with a ``text`` of one line for a reader.

    Raises:
        ConfigError: if it cannot be written, or others could change it.
    """
    place = place_of(kind)
    try:
        place.mkdir(parents=True, exist_ok=True, mode=0o700)
        if reason := exposed(place):
            raise ConfigError(f"{text} cannot be remembered: {reason}")
        new = place / f".{os.getpid()}"
        new.unlink(missing_ok=True)
        with os.fdopen(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as stream:
            stream.write(f"{text}\n")
        new.replace(place / digest)
    except OSError as error:
        raise ConfigError(f"{text} cannot be remembered: {place}: {error.strerror}") from error


def all_remembered(kind: str) -> dict[str, str]:
    """The texts of all that is remembered, by digest.

    Raises:
        ConfigError: if others could have changed it.
    """
    if reason := not_believed(kind):
        raise ConfigError(f"what you agreed to is not read: {reason}")
    found = {file.name: content_of_own(file) for file in place_of(kind).glob("[!.]*")}
    return {name: text.decode().strip() for name, text in found.items() if text is not None}


def not_believed(kind: str) -> str:
    """Why the stored files are not used; empty if they are."""
    place = place_of(kind)
    return exposed(place) if place.is_dir() else ""
