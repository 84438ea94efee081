"""Results of one stage for several options, side by side: ``<tree>/traces/<digest of the options>``.

``<tree>/trace`` is a link to the one that was asked for last, so that its path is always the same. Only the
holder of the tree's lock may call what writes here.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hybridid.naming import counted
from pipelines.shared.config import Settings, digest_of
from pipelines.shared.freshness import RECEIPT, Fingerprint, made_from_of
from pipelines.shared.stage import Stage
from pipelines.shared.tree import point_to, remove

SHOWN = 2
"""Options of an earlier result that its line names."""


@dataclass(frozen=True)
class Kept:
    """Results in ``folder``, and the ``options`` (flat keys) in which they differ from those asked for."""

    folder: Path
    options: Mapping[str, Any]


def results_folder(stage: Stage, settings: Settings, root: Path) -> Path:
    """Where the results of ``stage`` with these settings lie in the tree ``root``."""
    if not stage.side_by_side:
        return root / stage.name
    return _home(stage, root) / digest_of(stage.options(settings))[:8]


def show_newest(stage: Stage, folder: Path, root: Path) -> None:
    """Let ``<root>/<stage>`` lead to the results in ``folder``."""
    if stage.side_by_side:
        point_to(root / stage.name, folder)


def take_in(stage: Stage, root: Path) -> None:
    """Results that an earlier version wrote at the place of the link become one of the several."""
    old = root / stage.name
    if not stage.side_by_side or old.is_symlink() or not old.is_dir():
        return
    then = made_from_of(old)
    if then is None:
        remove(old)
        return
    home = _home(stage, root)
    home.mkdir(exist_ok=True)
    folder = home / digest_of(then["config"])[:8]
    remove(folder)
    old.rename(folder)
    show_newest(stage, folder, root)


def remove_results(stage: Stage, root: Path) -> int:
    """Remove all results of ``stage``; how many there were."""
    if not stage.side_by_side:
        return int(remove(root / stage.name))
    link, home = root / stage.name, _home(stage, root)
    if link.is_symlink():
        link.unlink()
    several = sum(made_from_of(folder) is not None for folder in home.glob("*"))
    return max(int(remove(home)), several)


def with_other_options(stage: Stage, folder: Path, now: Fingerprint) -> list[Kept]:
    """The results that lie beside ``folder`` and were made from the same inputs, the newest first."""
    if not stage.side_by_side:
        return []
    found = []
    for other in (path for path in folder.parent.iterdir() if path != folder):
        then = made_from_of(other)
        if then is not None and then["inputs"] == now["inputs"]:
            found.append(((other / RECEIPT).stat().st_mtime_ns, Kept(other, _differing(then, now))))
    return [kept for _, kept in sorted(found, key=lambda one: one[0], reverse=True)]


def in_words(kept: list[Kept]) -> str:
    """One line that says where they lie."""
    first, more = kept[0], len(kept) - 1
    options = [f"{key}={_short(value)}" for key, value in first.options.items()]
    beyond = f" and {counted(len(options) - SHOWN, 'other option')}" if len(options) > SHOWN else ""
    rest = f"; {more} more {'lies' if more == 1 else 'lie'} beside it" if more else ""
    return f"an earlier result, with {', '.join(options[:SHOWN])}{beyond}, is kept in {first.folder}{rest}"


def _home(stage: Stage, root: Path) -> Path:
    return root / f"{stage.name}s"


def _differing(then: Fingerprint, now: Fingerprint) -> dict[str, Any]:
    """The options of ``then`` that are not those of ``now``."""
    before, current = then["config"], json.loads(json.dumps(now["config"], default=str))
    keys = sorted({*before, *current})
    return {key: before.get(key) for key in keys if before.get(key) != current.get(key)}


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False).replace('"', "")
    return text if len(text) <= 60 else text[:57] + "..."
