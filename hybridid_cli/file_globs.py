"""``records.NAME.files=glob(PATTERN)``: a value for each recording that the pattern finds.

Hydra's own ``glob`` names the files of a config group. Recordings lie in the folders in which a record is
looked for: ``paths.data``, ``$HYBRIDID_DATA``, ``data/raw`` and the user's own.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from hybridid.records.sources import DataRoot
from pipelines.shared.errors import ConfigError

_GLOB = re.compile(r"(?P<key>\+*[^=]*\.files)=glob\((?P<pattern>[^()]*)\)")


def with_files(words: Sequence[str], roots: Iterable[DataRoot]) -> list[str]:
    """``words`` with the names of the files in the place of each pattern, in the order of their names.

    Raises:
        ConfigError: if a pattern finds no file; names the folders.
    """
    folders = list(roots)
    return [_expanded(word, folders) for word in words]


def _expanded(word: str, roots: Sequence[DataRoot]) -> str:
    asked = _GLOB.fullmatch(word)
    if asked is None:
        return word
    pattern = asked["pattern"].strip().strip("'\"")
    files = _found(pattern, roots)
    if not files:
        looked = ", ".join(map(str, roots))
        raise ConfigError(f"{word}: no file is called so; looked under {looked}")
    return f"{asked['key']}=choice({','.join(map(_quoted, files))})"


def _quoted(name: str) -> str:
    escaped = name.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"


def _found(pattern: str, roots: Sequence[DataRoot]) -> list[str]:
    """Names below the first folder that has any, as a record gives them."""
    given = Path(pattern).expanduser()
    if given.is_absolute():
        return sorted(str(path) for path in Path(given.anchor).glob(str(given.relative_to(given.anchor))))
    for root in roots:
        found = sorted(path.relative_to(root.path).as_posix() for path in root.path.glob(pattern))
        if found:
            return found
    return []
