"""``plot``: the figures of a fitted and validated model, each as SVG, PDF and PNG."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hybridid.declarations import Port
from hybridid.estimators.estimate import Estimate
from hybridid.hybrid import PortHybrid
from hybridid.model import Model
from hybridid.plotting.comparison import comparison_plot
from hybridid.plotting.error import error_plot
from hybridid.plotting.friction import FrictionCurve, FrictionData, friction_plot
from hybridid.plotting.parameters import parameters_plot
from hybridid.plotting.raincloud import raincloud_plot
from hybridid.plotting.record import record_plot
from hybridid.plotting.residual_correlation import residual_correlation_plot
from hybridid.plotting.series import Response
from hybridid.plotting.spectrum import spectrum_plot
from hybridid.plotting.style import Plot, save
from hybridid.records.record import Record
from hybridid.records.store import load_record
from hybridid.validation.port_efforts import port_efforts, resisting_effort
from pipelines.findings import estimate_of, prepared_records
from pipelines.fitted import load
from pipelines.hybrids import hybrid_of
from pipelines.predictions import Stored, Tested, predictions_in, residual_tests_in
from pipelines.stage import Job, Stage

Named = Iterator[tuple[str, Plot]]


@dataclass(frozen=True, eq=False)
class _Law:
    """A model whose efforts are drawn over velocity, by the name under which it was validated."""

    name: str
    model: Model
    values: Mapping[str, float]


def run(job: Job) -> None:
    """Draw everything; files are called ``<record>.<output or port>.<figure>``."""
    model, estimate = load(job.tree)
    laws = _laws(job, model, estimate)
    stored = predictions_in(job.tree)
    tests = residual_tests_in(job.tree)
    for prepared in prepared_records(job.tree):
        record = load_record(prepared.file)
        job.watcher.progress("plot", f"record {record.name}", None)
        save(record_plot(record), job.folder, f"{record.name}.record")
        own = [s for s in stored if s.prediction.record == record.name]
        for name, plot in _of_record(laws, record, own, tests):
            save(plot, job.folder, name)
    for name, plot in _of_model(model, estimate, stored, estimate_of(job.tree)):
        save(plot, job.folder, name)


def _laws(job: Job, model: Model, estimate: Estimate) -> list[_Law]:
    """The gray box, and the hybrid where its network stands inside the equations."""
    laws = [_Law(str(estimate_of(job.tree)["model"]), model, estimate.values)]
    hybrid = hybrid_of(job.tree, model)
    if isinstance(hybrid, PortHybrid):
        laws.append(_Law(hybrid.name, hybrid.model, hybrid.values))
    return laws


def _of_record(
    laws: Sequence[_Law], record: Record, stored: Sequence[Stored], tests: Sequence[Tested]
) -> Named:
    """Figures of one record: each output in every view, and each port."""
    if not stored:
        return
    for output in (channel.name for channel in record.output_channels):
        responses = [Response.of(s.model, s.prediction, output) for s in stored]
        free = [r for s, r in zip(stored, responses, strict=True) if s.horizon is None]
        stem = f"{record.name}.{output}"
        yield f"{stem}.comparison", comparison_plot(responses)
        yield f"{stem}.error", error_plot(responses)
        yield f"{stem}.spectrum", spectrum_plot(free or responses)  # horizons' jumps are in every frequency
        for test in tests:
            if (test.found.record, test.found.output) == (record.name, output):
                kind = "residual" if test.model == laws[0].name else "hybrid.residual"
                yield f"{stem}.{kind}.{test.view}", residual_correlation_plot(test.model, test.found)
    yield from _friction(laws, record, stored)


def _friction(laws: Sequence[_Law], record: Record, stored: Sequence[Stored]) -> Named:
    """The efforts at each port, of every law along the last of its own predictions."""
    curves: dict[str, list[FrictionCurve]] = {}
    ports: dict[str, Port] = {}
    for law in laws:
        own = [s for s in stored if s.model == law.name]
        for at in port_efforts(law.model, law.values, record, own[-1].prediction) if own else ():
            order = np.argsort(at.velocity) if at.static else np.arange(len(at.velocity))
            efforts = {name.partition(".")[2]: effort[order] for name, effort in at.efforts.items()}
            curves.setdefault(at.port.name, []).append(FrictionCurve(law.name, at.velocity[order], efforts))
            ports[at.port.name] = at.port
    for name, drawn in curves.items():
        found = resisting_effort(laws[0].model, laws[0].values, record, ports[name])
        data = None if found is None else FrictionData(*found)
        plot = friction_plot(ports[name], drawn, record.name, record.provenance, data)
        yield f"{record.name}.{name}.friction", plot


def _of_model(model: Model, estimate: Estimate, stored: Sequence[Stored], about: Mapping[str, Any]) -> Named:
    """Figures over all records: the spread of errors, the estimates."""
    for output in model.outputs if stored else ():
        yield (
            f"{output.name}.raincloud",
            raincloud_plot([Response.of(s.model, s.prediction, output.name) for s in stored]),
        )
    fitted = ", ".join(about["records"])
    estimates = {about["model"]: estimate}
    yield "parameters", parameters_plot(estimates, model.parameters, fitted, about["provenance"])


PLOT = Stage("plot", (), ("preprocess", "fit", "residual", "validate"), run, ignores=("rigs", "fetch"))
