"""Whether a stage's results still answer the question: what they were made from, then and now."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import hybridid

RECEIPT = "stage.json"
Fingerprint = dict[str, dict[str, Any]]


def fingerprint(
    config: Mapping[str, Any], inputs: Mapping[str, str], without: Iterable[str] = ()
) -> Fingerprint:
    """What results depend on: flat config keys, digests of what is read, and hybridid's own code.

    ``without`` names subpackages of hybridid that do not matter to the stage.
    """
    code = {"hybridid": hybridid.__version__, "code": code_digest(tuple(without))}
    return {"config": dict(config), "inputs": dict(inputs), "code": code}


def why_stale(folder: Path, now: Fingerprint) -> list[str]:
    """What has changed since ``folder`` was made, in words; empty if nothing has."""
    try:
        then = json.loads((folder / RECEIPT).read_text(encoding="utf-8"))["fingerprint"]
    except (OSError, ValueError, KeyError):
        return ["not made yet"]
    now = json.loads(json.dumps(now, default=str))
    return [
        _reason(section, key, before.get(key), current.get(key))
        for section, current in now.items()
        for before in (then.get(section, {}),)
        for key in sorted({*current, *before})
        if current.get(key) != before.get(key)
    ]


def write_receipt(folder: Path, stage: str, made_from: Fingerprint, seconds: float) -> None:
    """Leave in ``folder`` what its files were made from."""
    receipt = {"stage": stage, "seconds": round(seconds, 3), "fingerprint": made_from}
    (folder / RECEIPT).write_text(json.dumps(receipt, indent=1, default=str) + "\n", encoding="utf-8")


def folder_digest(folder: Path) -> str:
    """SHA-256 over the names and contents of a stage's files, its receipt apart."""
    total = hashlib.sha256()
    for path in sorted(p for p in folder.rglob("*") if p.is_file() and p.name != RECEIPT):
        total.update(path.relative_to(folder).as_posix().encode() + b"\0" + file_digest(path).encode())
    return total.hexdigest()


def file_digest(path: Path) -> str:
    """SHA-256 of a file."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


@cache
def code_digest(without: tuple[str, ...] = ()) -> str:
    """SHA-256 over hybridid's Python files, less the subpackages named."""
    root = Path(hybridid.__file__).parent
    total = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        where = path.relative_to(root)
        if where.parts[0] not in without:
            total.update(where.as_posix().encode() + b"\0" + path.read_bytes())
    return total.hexdigest()


def _reason(section: str, key: str, before: Any, now: Any) -> str:
    if section == "code":
        return "hybridid's version changed" if key == "hybridid" else "hybridid's code changed"
    if section == "inputs":
        kinds = [str(digest).partition(" ")[0] for digest in (before, now) if digest]
        return f"{key} changed" + (
            f" ({' -> '.join(kinds)})" if len(set(kinds)) > 1 and len(kinds[0]) < 10 else ""
        )
    return f"{key} changed ({_short(before)} -> {_short(now)})"


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else text[:57] + "..."
