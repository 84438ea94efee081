"""``reproduce``: runs the thesis' experiments and writes its tables and figures beside ours on one page.

Experiments run in parallel. Fresh results are reused, so an interrupted run continues where it stopped. If an
experiment fails, the page gives the reason and shows the results of the others.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from pipelines.runner import run_stages
from pipelines.shared.board import Board
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, Incomplete
from pipelines.shared.limits import check_processes
from pipelines.shared.page import Page
from pipelines.shared.pool import Lost, core_count, side_by_side
from pipelines.shared.secrets import masked
from pipelines.shared.tree import replacing, write_text
from pipelines.shared.watch import Watcher
from pipelines.thesis.look_up import Failed
from pipelines.tracking.note import one_line
from pipelines.tracking.runs import tracked

LAST_STAGE = "validate"
"""The last stage of an experiment. Plots are not needed: the page draws the thesis' figures itself."""


@dataclass(frozen=True)
class Done:
    """A finished experiment: its run tree and its duration in s."""

    tree: Path
    seconds: float


def reproduce(
    experiments: Mapping[str, Settings], outputs: Path, watcher: Watcher, processes: int | None = None
) -> Path:
    """Run every experiment, ``processes`` in parallel (None: one per core), and write
    ``outputs/thesis/index.html`` and ``index.md``.

    Returns the page's path.

    Raises:
        ConfigError: if ``processes`` is not a positive integer.
        Incomplete: if experiments failed. The page is written before; the message names them.
    """
    if processes is not None and (isinstance(processes, bool) or processes < 1):
        raise ConfigError(f"processes is {processes!r}: at least 1, or null for one per core")
    for settings in experiments.values():
        check_processes(processes, "processes", settings)
    outcomes = _run(experiments, processes or core_count(), watcher)
    folder = outputs / "thesis"
    folder.mkdir(parents=True, exist_ok=True)
    page = _page(experiments, outcomes, folder, watcher).write(folder)
    failed = {name: outcome.reason for name, outcome in outcomes.items() if isinstance(outcome, Failed)}
    if failed:
        listed = "; ".join(f"{name} ({reason})" for name, reason in failed.items())
        raise Incomplete(
            f"{len(failed)} of {len(outcomes)} experiments failed: {listed}; "
            f"the page shows the others: {page}"
        )
    return page


def attempt(settings: Settings, watcher: Watcher) -> Done | Failed:
    """Run one experiment up to its validation; an exception becomes the result ``Failed``."""
    began = time.monotonic()
    try:
        with tracked(settings, "run", watcher) as logged:
            outcome = run_stages(settings, LAST_STAGE, watcher)
            logged.finish(outcome)
    except Exception as error:
        return Failed(one_line(error), masked(traceback.format_exc()))
    return Done(outcome.tree, time.monotonic() - began)


def _run(experiments: Mapping[str, Settings], processes: int, watcher: Watcher) -> dict[str, Done | Failed]:
    """The outcome of every experiment, in the order of ``experiments``."""
    board = Board("thesis", list(experiments), watcher)
    found: dict[str, Done | Failed] = {}
    if processes == 1 or len(experiments) == 1:
        for name, settings in experiments.items():
            board.of(name).say("begins")
            found[name] = _reported(board, name, attempt(settings, board.of(name)))
    else:
        for name, outcome in side_by_side(attempt, experiments, processes, board.of):
            result = Failed(outcome.reason) if isinstance(outcome, Lost) else outcome
            found[name] = _reported(board, name, result)
    return {name: found[name] for name in experiments}


def _reported(board: Board, name: str, outcome: Done | Failed) -> Done | Failed:
    """Show the outcome on the board and return it."""
    if isinstance(outcome, Failed):
        board.failed(name, outcome.reason)
    else:
        board.done(name, outcome.seconds)
    return outcome


def _page(
    experiments: Mapping[str, Settings],
    outcomes: Mapping[str, Done | Failed],
    folder: Path,
    watcher: Watcher,
) -> Page:
    """Draw the figures, write the traceback of each failed experiment, and return the page."""
    from pipelines.thesis.page import drawn, thesis_page
    from pipelines.thesis.views import Runs  # matplotlib takes a second to import

    trees = {name: o.tree if isinstance(o, Done) else o for name, o in outcomes.items()}
    runs = Runs(experiments, trees)
    with replacing(folder / "figures") as new:
        captions = drawn(runs, new, watcher)
    for old in folder.glob("failed-*.txt"):
        old.unlink()
    for name, outcome in outcomes.items():
        if isinstance(outcome, Failed) and outcome.traceback:
            write_text(folder / f"failed-{name}.txt", outcome.traceback)
    seconds = {name: o.seconds for name, o in outcomes.items() if isinstance(o, Done)}
    return thesis_page(runs, captions, folder / "figures", seconds)
