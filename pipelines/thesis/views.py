"""Data and panels of the thesis' figures: records, predictions and efforts from the run trees."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hybridid.plotting.looks import DATA, Look, look
from hybridid.plotting.panels import Line, Panel
from hybridid.plotting.series import Response
from hybridid.plotting.spectrum import amplitude_density
from hybridid.quantities import number, per_root_hertz
from hybridid.records.record import Record
from hybridid.records.store import load_record
from pipelines.shared.config import Settings
from pipelines.shared.predictions import Stored, predictions_in
from pipelines.shared.prepared import prepared_records
from pipelines.shared.sources import sources_of
from pipelines.thesis.look_up import Missing, NotRun, Outcomes, tree_of

Array = NDArray[np.float64]
FOCUS = 0.08
"""The fraction of a record that the enlarged panel shows."""
LOOKS: Mapping[str, Look] = {"gray box": look(0), "hybrid": look(1), "network": look(1)}


@dataclass(frozen=True, eq=False)
class Run:
    """The results of one experiment, read on demand."""

    settings: Settings
    tree: Path

    def record(self, role: str) -> Record:
        """The prepared record with this role.

        Raises:
            Missing: if there is none.
        """
        for prepared in prepared_records(self.tree):
            if prepared.role == role:
                return load_record(prepared.file)
        raise Missing(f"no record for {role}")

    def raw(self, role: str) -> Record:
        """The record with this role before any preprocessing.

        Raises:
            Missing: if there is none.
        """
        for source in sources_of(self.settings).found:
            if source.role == role:
                return source.record()
        raise Missing(f"no record for {role}")

    @cached_property
    def stored(self) -> list[Stored]:
        """Every prediction of the experiment."""
        return predictions_in(self.tree)

    def both(self, role: str, output: str, view: str = "free_run") -> dict[str, Response]:
        """The responses to a record by ``gray box`` and ``hybrid``.

        Raises:
            Missing: if one of them has no prediction in this view.
        """
        record = self.record(role).name
        found: dict[str, Response] = {}
        gray = self.stored[0].model if self.stored else ""
        for stored in self.stored:
            if (stored.prediction.record, stored.prediction.view) == (record, view):
                kind = "gray box" if stored.model == gray else "hybrid"
                found[kind] = Response.of(stored.model, stored.prediction, output)
        if "gray box" not in found:
            raise Missing("no prediction in free run")
        if "hybrid" not in found:
            raise Missing("no prediction of the hybrid")
        return found


@dataclass(frozen=True, eq=False)
class Runs:
    """All requested experiments."""

    experiments: Mapping[str, Settings]
    outcomes: Outcomes

    def __getitem__(self, experiment: str) -> Run:
        """An experiment's results.

        Raises:
            Missing: if it was not requested, or failed.
        """
        tree = tree_of(experiment, self.outcomes)
        return Run(self.experiments[experiment], tree)

    def first(self, experiments: Iterable[str]) -> Run:
        """The first of experiments on the same records that has results.

        Raises:
            Missing: if none has.
        """
        missing: Missing = NotRun("not run")
        for experiment in experiments:
            try:
                return self[experiment]
            except NotRun:
                continue
            except Missing as reason:
                missing = reason
        raise missing


def response_panel(title: str, shown: Mapping[str, Response], focus: bool = True) -> Panel:
    """The recorded output and each model's response; the title gives their RMSE."""
    data = next(iter(shown.values()))
    lines = [Line(data.provenance, data.time, data.measured, DATA)]
    lines += [Line(name, r.time, r.predicted, LOOKS[name]) for name, r in shown.items()]
    return Panel(
        f"{title}: {_scores(shown)}",
        ("time", "s"),
        (data.output, data.unit),
        lines,
        focus=_worst_part(data) if focus else None,
    )


def error_panel(
    title: str, shown: Mapping[str, Response], network: bool = False, focus: bool = True
) -> Panel:
    """Each model's error, recorded minus model; with ``network`` the gray box' error and the network's
    prediction of it."""
    data = next(iter(shown.values()))
    gray = shown["gray box"]
    lines = [Line("gray box, error", gray.time, gray.error, DATA if network else LOOKS["gray box"])]
    if "hybrid" in shown:
        hybrid = shown["hybrid"]
        n = min(len(gray.time), len(hybrid.time))
        of_network = hybrid.predicted[:n] - gray.predicted[:n]
        lines += (
            [Line("network, free run", hybrid.time[:n], of_network, LOOKS["network"])]
            if network
            else [Line("hybrid, error", hybrid.time, hybrid.error, LOOKS["hybrid"])]
        )
    return Panel(
        f"{title}: {_scores(shown)}",
        ("time", "s"),
        (f"error of {data.output}", data.unit),
        lines,
        focus=_worst_part(data) if focus else None,
    )


def spectrum_panel(title: str, shown: Mapping[str, Response]) -> Panel:
    """Amplitude spectral densities of the recorded output and of each model's response."""
    data = next(iter(shown.values()))
    lines = [Line(data.provenance, *amplitude_density(data.time, data.measured, data.record), DATA)]
    lines += [
        Line(name, *amplitude_density(r.time, r.predicted, r.model), LOOKS[name]) for name, r in shown.items()
    ]
    of = ("amplitude density", per_root_hertz(data.unit))
    return Panel(title, ("frequency", "Hz"), of, lines, kind="spectrum")


def scatter_panel(title: str, shown: Mapping[str, Response]) -> Panel:
    """Each model's response over the recorded output, sample by sample."""
    data = next(iter(shown.values()))
    lines = [Line(name, r.measured, r.predicted, LOOKS[name]) for name, r in shown.items()]
    name = data.output
    return Panel(
        title, (f"{name}, {data.provenance}", data.unit), (f"{name}, model", data.unit), lines, "scatter"
    )


def signal_panels(record: Record, names: tuple[str, ...], raw: Record | None = None) -> list[Panel]:
    """Signals of a record over time, drawn over the same signals of ``raw`` if it is given."""
    panels = []
    for name in names:
        values, unit = _signal(record, name)
        lines = [] if raw is None else [Line("as recorded", raw.time, _signal(raw, name)[0], DATA)]
        label = "as used" if raw is not None else record.provenance
        lines.append(Line(label, record.time, values, LOOKS["gray box"]))
        panels.append(Panel(name.replace("_", " "), ("time", "s"), (name, unit), lines))
    return panels


def spectra_of(record: Record, names: tuple[str, ...]) -> list[Panel]:
    """Amplitude spectral densities of signals of a record."""
    panels = []
    for name in names:
        values, unit = _signal(record, name)
        line = Line(record.provenance, *amplitude_density(record.time, values, name), LOOKS["gray box"])
        of = ("amplitude density", per_root_hertz(unit))
        title = f"{name.replace('_', ' ')}, spectrum"
        panels.append(Panel(title, ("frequency", "Hz"), of, [line], kind="spectrum"))
    return panels


def _signal(record: Record, name: str) -> tuple[Array, str]:
    units = {channel.name: channel.unit for channel in record.channels}
    if name not in units:
        raise Missing(f"record {record.name} holds no {name}")
    return record.signal(name), units[name]


def _scores(shown: Mapping[str, Response]) -> str:
    errors = ", ".join(f"{name} {number(response.rmse, 3)}" for name, response in shown.items())
    return f"RMSE {errors} {next(iter(shown.values())).unit}"


def _worst_part(response: Response) -> tuple[float, float]:
    """The part of the record around the gray box' largest error."""
    start, stop = float(response.time[0]), float(response.time[-1])
    length = FOCUS * (stop - start)
    moment = float(response.time[int(np.argmax(np.abs(response.error)))])
    low = min(max(moment - length / 2, start), stop - length)
    return low, low + length
