"""Whether a stage's results are up to date: compares the inputs they were made from with those of now."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import hybridid
from pipelines.shared.source_code import code_of

RECEIPT = "stage.json"
Fingerprint = dict[str, dict[str, Any]]


def fingerprint(config: Mapping[str, Any], inputs: Mapping[str, str], module: str) -> Fingerprint:
    """What results depend on: config keys, digests of the files read and of the code that ``module`` runs,
    and the versions of the numerical libraries that this code imports."""
    code = {"hybridid": hybridid.__version__, **code_of(module)}
    return {"config": dict(config), "inputs": dict(inputs), "code": code}


def why_stale(folder: Path, now: Fingerprint) -> list[str]:
    """What has changed since ``folder`` was made, a phrase for each change; empty if nothing has."""
    then = made_from_of(folder)
    if then is None:
        return ["not made yet"]
    now = json.loads(json.dumps(now, default=str))
    return [
        _reason(section, key, before.get(key), current.get(key))
        for section, current in now.items()
        for before in (then.get(section, {}),)
        for key in sorted({*current, *before})
        if current.get(key) != before.get(key)
    ]


def made_from_of(folder: Path) -> Fingerprint | None:
    """What the results in ``folder`` were made from; None if there are none."""
    try:
        receipt = json.loads((folder / RECEIPT).read_text(encoding="utf-8"))
        return {part: dict(receipt["fingerprint"][part]) for part in ("config", "inputs", "code")}
    except (OSError, ValueError, KeyError, TypeError):
        return None


def write_receipt(folder: Path, stage: str, made_from: Fingerprint, seconds: float) -> None:
    """Write into ``folder`` what its files were made from."""
    receipt = {"stage": stage, "seconds": round(seconds, 3), "fingerprint": made_from}
    (folder / RECEIPT).write_text(json.dumps(receipt, indent=1, default=str) + "\n", encoding="utf-8")


def folder_digest(folder: Path) -> str:
    """SHA-256 over the names and contents of a stage's files, without its receipt and without the seconds
    that it took: results made again are the same if only these differ."""
    total = hashlib.sha256()
    for path in sorted(p for p in folder.rglob("*") if p.is_file() and p.name != RECEIPT):
        total.update(path.relative_to(folder).as_posix().encode() + b"\0" + _result_digest(path).encode())
    return total.hexdigest()


def _result_digest(path: Path) -> str:
    """SHA-256 of a file; of JSON without the entries ``seconds``."""
    if path.suffix != ".json":
        return file_digest(path)
    try:
        content = json.loads(path.read_text(encoding="utf-8"), object_hook=_without_seconds)
    except ValueError:
        return file_digest(path)
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _without_seconds(entries: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in entries.items() if key != "seconds"}


def file_digest(path: Path) -> str:
    """SHA-256 of a file."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _reason(section: str, key: str, before: Any, now: Any) -> str:
    if section == "code":
        if "." in key:
            return f"the code of {key} changed"
        return f"{key} changed ({before} -> {now})" if before and now else f"{key} changed"
    if section == "inputs":
        kinds = [str(digest).partition(" ")[0] for digest in (before, now) if digest]
        return f"{key} changed" + (
            f" ({' -> '.join(kinds)})" if len(set(kinds)) > 1 and len(kinds[0]) < 10 else ""
        )
    return f"{key} changed ({_short(before)} -> {_short(now)})"


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else text[:57] + "..."
