"""``hybridid trust``, and the question on a terminal whether code that a file names may run."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from pipelines.shared.errors import ConfigError
from pipelines.shared.own_code import code_in
from pipelines.shared.remembered import place_of
from pipelines.shared.trust import TRUSTED, Untrusted, all_trusted, is_trusted, printable, trust

_LISTED = 12


def command(name: str, words: Sequence[str]) -> int:
    """Trust the code in each folder named; without a folder, list what is trusted."""
    for word in words:
        if word.startswith("-"):
            raise ConfigError(f"{word} is no folder, as in hybridid trust ../their-models")
    for word in words:
        print(f"trusted: {trust(Path(word)).folder}, {_counted(Path(word))}, until one of them changes")
    if not words:
        for one in all_trusted():
            now = Path(one.folder)
            remark = "" if now.is_dir() and is_trusted(now) else "  (changed since: no longer trusted)"
            print(f"{printable(one.folder)}  {one.digest[:12]}{remark}")
        print(f"each is a file in {place_of(TRUSTED)}; remove it, and the folder is no longer trusted")
    return 0


def trusted_when_asked(asking: Untrusted) -> bool:
    """Ask on the terminal whether the code may run, and remember a yes; False without a terminal."""
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        return False
    files = [printable(path.relative_to(asking.folder)) for path in code_in(asking.folder)]
    more = f" and {len(files) - _LISTED} more" if len(files) > _LISTED else ""
    said = (
        f"{asking.what} names code in {printable(asking.folder)}: {', '.join(files[:_LISTED])}{more}.\n"
        "Code that runs can do whatever you can do. Trust it until a file changes? [y/N] "
    )
    print(said, end="", file=sys.stderr, flush=True)
    if sys.stdin.readline().strip().lower() not in ("y", "yes"):
        return False
    trust(asking.folder)
    return True


def _counted(folder: Path) -> str:
    number = len(code_in(folder))
    return f"{number} file{'s' * (number != 1)} of code"
