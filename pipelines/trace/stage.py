"""``trace``: what the model lacks, found by refitting every effect, proved, and reported.

Writes ``trace.json``, ``model.json`` (the augmented model), ``report.html`` and ``report.md`` with their
figures, and the missing efforts as Parquet.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

from hybridid.records.record import Record
from hybridid.trace.ceiling import Ceiling, ceiling
from hybridid.trace.mapper import Mapper
from hybridid.trace.split import Split
from hybridid.trace.verdict import Trace, trace
from pipelines.shared import modelling
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.findings import loaded_estimate, prepared_records
from pipelines.shared.fitted import describe_model
from pipelines.shared.imports import code_digests
from pipelines.shared.modelling import fit_settings, model_of, named_code
from pipelines.shared.page import Picture
from pipelines.shared.sources import sources_of
from pipelines.shared.stage import Job, Stage
from pipelines.shared.storage import write_json
from pipelines.shared.workers import workers
from pipelines.trace.complete import completed
from pipelines.trace.missing import Missing, missing_efforts, write_missing
from pipelines.trace.page import trace_page
from pipelines.trace.proof import AFTER, BEFORE, Ask, Proof, prove
from pipelines.trace.request import Request, division, fitting_horizon, own_effects, request_of, split_of
from pipelines.trace.story import Story

FORMATS = ("svg",)
"""Of the figures: the report holds them; what is wanted elsewhere any browser prints."""


def run(job: Job) -> None:
    """Search, prove, and write everything."""
    began = time.perf_counter()
    prepared = prepared_records(job.tree)
    asked = request_of(job.settings)
    request = fitting_horizon(asked, prepared, job.settings)
    if request.horizon < asked.horizon:
        job.watcher.warn(
            f"trace.horizon: {request.horizon:.3g} s; the records are too short for {asked.horizon:g} s"
        )
    split = split_of(prepared, job.settings, request.horizon)
    with workers(request.processes) as mapper:
        found = trace(
            model_of(job.settings),
            split,
            request.effects,
            request.rules,
            start=[loaded_estimate(job.tree).values],
            mapper=mapper,
            report=_Report(job),
            ports=request.ports,
            integrator=fit_settings(job.settings).integrator,
        )
        proofs = _proved(job, request, split, found, mapper)
        ceilings = _ceilings(job, split, found, mapper)
        networks = completed(
            proofs, ceilings, _parts(job, split), _ask(job, request, split), mapper, _Report(job)
        )
        missing = _missing(job, request, split, proofs, mapper)
    divided = division(prepared, job.settings)
    story = Story(job.settings, request, split, *divided, found, proofs, ceilings, networks)
    _write(job, story, missing, began)


class _Report:
    """Hands a search's progress to the watcher."""

    def __init__(self, job: Job) -> None:
        self._watcher = job.watcher

    def __call__(self, stage: str, done: int, of: int, what: str) -> None:
        self._watcher.progress(stage, f"{done} of {of}, {what}", done / of)


def _proved(job: Job, request: Request, split: Split, found: Trace, mapper: Mapper) -> list[Proof]:
    """The declared model and, if anything was accepted, the augmented one."""
    ask, parts = _ask(job, request, split), _parts(job, split)
    asked = {BEFORE: found.search.first} | ({AFTER: found.search.final} if found.accepted else {})
    places = [(name, base.model, base.values, *parts, ask) for name, base in asked.items()]
    proofs: list[Proof] = []
    for proof in mapper(prove, places):
        proofs.append(proof)
        _Report(job)("before and after", len(proofs), len(places), proof.name)
    return proofs


def _parts(job: Job, split: Split) -> tuple[Sequence[Record], Sequence[Record]]:
    """The fitted records and the others."""
    fitted = len(division(prepared_records(job.tree), job.settings)[0])
    return split.records[:fitted], split.records[fitted:]


def _ask(job: Job, request: Request, split: Split) -> Ask:
    settings = replace(
        fit_settings(job.settings),
        method="gauss_newton",
        horizon=split.horizon,
        continuation=(1.0,),
        starts=1,
    )
    return Ask(settings, request.horizon, str(job.settings["validate.initial_state"]))


def _ceilings(job: Job, split: Split, found: Trace, mapper: Mapper) -> list[Sequence[Ceiling]]:
    """What a learned effort could add to each model."""
    if not found.accepted:
        return [found.ceilings]
    if found.ceilings_before:
        return [found.ceilings_before, found.ceilings]
    places = [(found.search.first, split, c.port, c.over) for c in found.ceilings]
    before: list[Ceiling] = []
    for one in mapper(ceiling, places):
        before.append(one)
        _Report(job)("ceiling before", len(before), len(places), f"{one.port} over {one.over}")
    return [before, found.ceilings]


def _missing(job: Job, request: Request, split: Split, proofs: Sequence[Proof], mapper: Mapper) -> Missing:
    model = proofs[0].model
    ports = [p.name for p in model.effort_ports if request.ports is None or p.name in request.ports]
    missing, failures = missing_efforts(proofs, split.records, ports, mapper, _Report(job))
    for failure in failures:
        job.watcher.warn(failure)
    return missing


def _write(job: Job, story: Story, missing: Missing, began: float) -> None:
    """The model, the numbers, then the figures and the pages that show them."""
    from hybridid.plotting.style import save
    from pipelines.trace.figures import Gallery  # matplotlib takes half a second to import

    augmented = story.augmented
    described = describe_model(augmented, model_of(augmented))
    write_json(job.folder / "model.json", {**described, "provenance": story.provenance})
    write_missing(job.folder, missing)
    data = story.data(job.tree / "trace" / "model.json", time.perf_counter() - began)
    write_json(job.folder / "trace.json", data)
    job.watcher.progress("report", "figures and pages", None)
    ceilings = dict(zip((proof.name for proof in story.proofs), story.ceilings, strict=True))
    gallery = Gallery(
        story.found, story.proofs, story.split.records, missing, ceilings,
        story.request.rules.worth, story.judged, story.provenance,
    )  # fmt: skip
    pictures = [
        Picture(save(plot, job.folder, name, FORMATS)[0], plot.caption) for name, plot in gallery.figures()
    ]
    trace_page(data, pictures).write(job.folder, "report")


def check(settings: Settings) -> None:
    """Whether the section ``trace`` can be carried out.

    Raises:
        ConfigError: if it cannot.
    """
    request = request_of(settings)
    division(sources_of(settings).found, settings)
    model = model_of(settings)
    kinds = {port.kind for port in model.plant.ports}
    if not any(effect.kind in kinds for effect in request.effects):
        raise ConfigError(f"trace.effects: plant {model.plant.name} has no port where any of them acts")


def _named_code(settings: Settings) -> dict[str, str]:
    library = [str(name) for name in settings.get("trace.effects") or ()]
    own = [name for name in (*library, *own_effects(settings)) if ":" in name]
    return {**named_code(settings), **code_digests(own)}


TRACE = Stage(
    "trace",
    (*modelling.KEYS, "estimator", "trace", "validate.initial_state"),
    ("preprocess", "fit"),
    run,
    inputs=_named_code,
    check=check,
)
