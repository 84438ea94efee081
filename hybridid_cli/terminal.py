"""What a running command shows: lines, warnings and a progress bar; log lines if stderr is not a terminal.

Results go to stdout, everything else to stderr.
"""

from __future__ import annotations

import re
import sys
import threading
import time
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn
from rich.text import Text

from hybridid_cli import interrupt

_SECONDS_BETWEEN_LINES = 5.0
_COUNT = re.compile(r"\d+ of \d+")
_SILENCE = 10.0
"""Seconds without a line after which a log is told that the work goes on."""


class Terminal:
    """A ``pipelines.shared.watch.Watcher`` on this process' terminal; use it as a context.

    ``label`` goes before every line (a sweep's job number); ``bar`` False never draws one.
    """

    def __init__(self, label: str = "", bar: bool = True) -> None:
        self._label = label
        self._console = Console(file=sys.stderr, highlight=False)
        self._watched = bar and self._console.is_terminal
        self._bar: Progress | None = None
        self._task = TaskID(0)
        self._last: tuple[float, str] = (0.0, "")
        self._doing, self._spoke = "", 0.0
        self._ended = threading.Event()

    def __enter__(self) -> Terminal:
        if not self._watched:
            threading.Thread(target=self._break_silence, daemon=True).start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._stop_bar()

    def say(self, line: str) -> None:
        """Print a line to stderr."""
        interrupt.check()
        self._line(Text(line))

    def warn(self, line: str) -> None:
        """Print a warning to stderr."""
        self._line(Text(f"WARNING: {line}", style="bold yellow"))

    def show(self, text: str) -> None:
        """Print a result to stdout in one write, so that parallel processes do not mix their lines."""
        self._stop_bar()
        self._doing = ""
        sys.stdout.write(f"{self._label}{text}\n" if self._label else f"{text}\n")
        sys.stdout.flush()

    def carry_on(self) -> None:
        """Raise ``Interrupted`` if Ctrl-C was pressed."""
        interrupt.check()

    def progress(self, work: str, state: str, fraction: float | None) -> None:
        """Update the bar, or without a terminal print a line every few seconds."""
        interrupt.check()
        if self._watched:
            self._draw(f"{work}: {state}", fraction)
            return
        now, self._doing = time.monotonic(), f"{work}: {state}"
        kind = _COUNT.sub("", work)  # a thousand short starts are one work
        if kind != self._last[1] or now - self._last[0] > _SECONDS_BETWEEN_LINES:
            self._last = (now, kind)
            self.say(self._doing)

    def _break_silence(self) -> None:
        """Say again how far the work is while nothing new is known of it."""
        while not self._ended.wait(_SILENCE / 10):
            if self._doing and time.monotonic() - self._spoke > _SILENCE:
                self._line(Text(f"{self._doing}; still at work"))

    def _line(self, line: Text) -> None:
        self._spoke = time.monotonic()
        if not self._console.is_terminal:
            line = Text(f"{time.strftime('%H:%M:%S')} {self._label}{line.plain}")
        elif self._label:
            line = Text(self._label) + line
        self._console.print(line, soft_wrap=True)

    def _draw(self, text: str, fraction: float | None) -> None:
        if self._bar is None:
            columns = (BarColumn(bar_width=30), TextColumn("{task.description}"), TimeElapsedColumn())
            self._bar = Progress(*columns, console=self._console, transient=True)
            self._task = self._bar.add_task("", total=None)
            self._bar.start()
        total = 1.0 if fraction else None  # nothing done, or nothing known: the bar only moves to and fro
        self._bar.update(self._task, description=text, completed=fraction or 0.0, total=total)

    def _stop_bar(self) -> None:
        if self._bar is not None:
            self._bar.stop()
            self._bar = None
