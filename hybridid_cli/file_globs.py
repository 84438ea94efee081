"""``records.NAME.files=glob(PATTERN)``: a value for each recording whose name matches the pattern.

Hydra's own ``glob`` searches the files of a config group. This one searches the folders of the records:
``paths.data``, ``$HYBRIDID_DATA``, ``data/raw`` and the user's own.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from hybridid.records.sources import DataRoot
from pipelines.shared.errors import ConfigError

_GLOB = re.compile(r"(?P<key>\+*[^=]*\.files)=glob\((?P<pattern>[^()]*)\)")


def with_files(words: Sequence[str], roots: Iterable[DataRoot]) -> list[str]:
    """``words`` with each pattern replaced by the sorted names of the files that match it.

    Raises:
        ConfigError: if no file matches a pattern; the message names the folders.
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
        raise ConfigError(f"{word}: no file matches this pattern; searched {looked}")
    return f"{asked['key']}=choice({','.join(map(_quoted, files))})"


def _quoted(name: str) -> str:
    escaped = name.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"


def _found(pattern: str, roots: Sequence[DataRoot]) -> list[str]:
    """Names of the files that match, from the first folder that has any; relative to that folder."""
    given = Path(pattern).expanduser()
    if given.is_absolute():
        return sorted(str(path) for path in Path(given.anchor).glob(str(given.relative_to(given.anchor))))
    for root in roots:
        found = sorted(path.relative_to(root.path).as_posix() for path in root.path.glob(pattern))
        if found:
            return found
    return []
