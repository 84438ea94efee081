"""Traces an entry by the command, as an engineer would, and reads what came of it."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from benchmarks.measured.entry import Asked
from hybridid.trace.entries import AcceptedEffect
from hybridid.trace.results.before_after import HELD_OUT, ScoreRow
from hybridid.trace.results.result import Trace
from pipelines.shared.errors import ConfigError
from pipelines.shared.traced import trace_of


@dataclass(frozen=True)
class Outcome:
    """What a trace said, or in ``failure`` why there is none."""

    asked: Asked
    found: Trace | None = None
    failure: str = ""

    @property
    def held_out(self) -> tuple[float, float]:
        """RMSE of the judge's output over held-out horizons, before and after."""
        return _of(self).path[0].held_out_rmse[self._output], _of(self).path[-1].held_out_rmse[self._output]

    @property
    def free_run(self) -> tuple[float, float]:
        """The judge's measure of the free run, before and after; the mean over its records."""
        return self._mean(_of(self).before), self._mean(_of(self).after)

    @property
    def unit(self) -> str:
        """Of the judge's output."""
        return next(row.unit for row in _of(self).after if row.output == self._output)

    @property
    def hit(self) -> str:
        """Whether what is known to lack is named: ``first``, ``later``, ``in the class of ...`` or ``no``."""
        for place, entry in enumerate(_of(self).accepted):
            if entry.effect in self.asked.wanted:
                return "later" if place else "first"
            if any(member in self.asked.wanted for member in entry.alike):
                return f"in the class of {entry.effect}"
        return "no"

    @property
    def _output(self) -> str:
        return self.asked.entry.judge.output

    def _mean(self, rows: Iterable[ScoreRow]) -> float:
        records = self.asked.entry.judge.records
        taken = [
            getattr(row, self.asked.entry.judge.measure)
            for row in rows
            if row.output == self._output and row.view == "free_run" and not row.network
            and (row.role == HELD_OUT if records is None else row.record in records)
        ]  # fmt: skip
        return sum(taken) / len(taken) if taken else math.nan


def named(entry: AcceptedEffect) -> str:
    """``carriage.load_friction (or input_saturation)``."""
    return f"{entry.name} (or {', '.join(entry.others)})" if entry.others else entry.name


def outcomes(every: Sequence[Asked], out: Path, processes: int) -> Iterator[Outcome]:
    """One for each trace as it ends, so many side by side; a finished one is read, not done again."""
    with ThreadPoolExecutor(processes) as pool:
        for done in as_completed([pool.submit(outcome, asked, out) for asked in every]):
            yield done.result()


def outcome(asked: Asked, out: Path) -> Outcome:
    """Trace, in a process of its own."""
    tree = out / "runs" / re.sub(r"[^\w/]+", "-", asked.key)
    command = [sys.executable, "-m", "hybridid_cli", "trace", *words(asked), f"out={tree.resolve()}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        said = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
        return Outcome(asked, failure=said[-1].removeprefix("hybridid: "))
    try:
        return Outcome(asked, trace_of(tree).found)
    except (ConfigError, OSError) as error:
        return Outcome(asked, failure=str(error))


def words(asked: Asked) -> list[str]:
    """Of the command, but for the place of its results."""
    entry = asked.entry
    own = [f"case={entry.case}", f"data={entry.data}", f"effects=[{','.join(asked.effects)}]"]
    return [*own, "trace.processes=1", "mlflow.enabled=false", *entry.options]


def _of(one: Outcome) -> Trace:
    assert one.found is not None
    return one.found
