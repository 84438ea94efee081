"""The figures of a trace: waterfall, trials, residual before and after, missing effort, ceilings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hybridid.plotting.error import error_plot
from hybridid.plotting.series import Response
from hybridid.plotting.style import Plot
from hybridid.plotting.trace_ceiling import LearnedCurve, ceiling_plot
from hybridid.plotting.trace_missing_effort import missing_effort_plot
from hybridid.plotting.trace_trials import Tried, trials_plot
from hybridid.plotting.trace_waterfall import Level, waterfall_plot
from hybridid.records.record import Record
from hybridid.trace.ceiling import Ceiling, factor
from hybridid.trace.missing_effort import MissingEffort
from hybridid.trace.search import Step
from hybridid.trace.verdict import Trace
from pipelines.trace.findings import path_entries
from pipelines.trace.proof import Proof

Named = Iterator[tuple[str, Plot]]


@dataclass(frozen=True)
class Gallery:
    """Everything that a trace's figures show.

    ``proofs`` are of the declared and, if anything was accepted, the augmented model; ``missing``
    the efforts that each lacks, by record and port; ``ceilings`` by model.
    """

    trace: Trace
    proofs: Sequence[Proof]
    records: Sequence[Record]
    missing: Mapping[tuple[str, str], Mapping[str, MissingEffort]]
    ceilings: Mapping[str, Sequence[Ceiling]]
    worth: float
    judged: str
    provenance: str

    def figures(self) -> Named:
        """Each figure under its file's name."""
        yield from self._waterfalls()
        for number, step in enumerate(self.trace.search.steps, 1):
            if step.trials:
                plot = trials_plot(_tried(step), self.worth, f"step {number}", self.judged, self.provenance)
                yield f"step{number}.trials", plot
        for record in self.records:
            yield from self._errors(record)
        yield from self._missing()
        shown = [(m, [c for c in found if not factor(c.over)]) for m, found in self.ceilings.items()]
        for port in dict.fromkeys(c.port for _, found in shown for c in found):
            curves = [_curve(m, c) for m, found in shown for c in found if c.port == port]
            yield f"{port}.ceiling", ceiling_plot(port, curves, self.judged, self.provenance)

    def _waterfalls(self) -> Named:
        path = path_entries(self.trace.search)
        for output in self.trace.model.outputs:
            levels = [Level(entry["label"], entry["held_out_rmse"][output.name]) for entry in path]
            floor = self.trace.floor[output.name]
            plot = waterfall_plot(levels, floor, output.name, output.unit, self.judged, self.provenance)
            yield f"{output.name}.waterfall", plot

    def _errors(self, record: Record) -> Named:
        """Over horizons: that is what was judged."""
        shown = [(p.name, found) for p in self.proofs if (found := p.over_horizons(record.name)) is not None]
        for output in self.trace.model.outputs if shown else ():
            responses = [Response.of(name, found, output.name) for name, found in shown]
            yield f"{record.name}.{output.name}.error", error_plot(responses)

    def _missing(self) -> Named:
        by_name = {record.name: record for record in self.records}
        for (record, port), efforts in self.missing.items():
            inputs = {
                channel.name: (np.asarray(by_name[record].inputs[:, k]), channel.unit)
                for k, channel in enumerate(by_name[record].input_channels)
            }
            yield f"{record}.{port}.missing_effort", missing_effort_plot(efforts, inputs)


def _tried(step: Step) -> list[Tried]:
    taken = step.accepted.name if step.accepted else ""
    return [
        Tried(t.candidate.name, t.gain, "accepted" if t.candidate.name == taken else t.status)
        for t in step.trials
    ]


def _curve(model: str, found: Ceiling) -> LearnedCurve:
    at, effort, samples = np.array(found.curve, dtype=float).T
    return LearnedCurve(model, found.over, at, effort, samples, found.unit, found.over_unit, found.gain)
