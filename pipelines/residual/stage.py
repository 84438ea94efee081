"""``residual``: a network on the error of the gray box, and the hybrid model of both.

Writes ``hybrid.json`` (with ``weights.npz`` for NARX), ``residual.json`` on how it came about, and for a
network inside the equations its ``estimate.json``. Without a section ``residual`` in the config the stage
is left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from hybridid.hybrid import FittedHybrid, GrayBox, save_hybrid
from hybridid.records.store import load_record
from pipelines.residual.narx import NARXRequest
from pipelines.residual.rbf import RBFRequest
from pipelines.residual.request import Request
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import fitted_model
from pipelines.shared.hybrids import Residual
from pipelines.shared.limits import check_and_tell, check_demand, check_processes
from pipelines.shared.modelling import fit_settings, model_of, named_code
from pipelines.shared.prepared import prepared_records
from pipelines.shared.sources import fitted_records
from pipelines.shared.stage import Job, Stage
from pipelines.shared.storage import write_json

NAME = "residual"
KINDS: Mapping[str, type[Request]] = {"narx": NARXRequest, "rbf": RBFRequest}


def run(job: Job) -> None:
    """Make the hybrid from the records that the gray box was fitted to."""
    gray = gray_box(job.settings, job.tree)
    request = request_of(job.settings)
    needed = request.demand(gray.model, gray.records, gray.estimate.settings)
    check_and_tell(needed, job.settings, job.watcher)
    write(job, gray, request.make(gray, job.watcher))


def gray_box(settings: Settings, tree: Path) -> GrayBox:
    """The fitted model of a tree, and which of its records it was fitted to."""
    model, estimate = fitted_model(settings, tree)
    prepared = prepared_records(tree)
    fitted = fitted_records(prepared, settings)
    records, unseen = (
        tuple(load_record(record.file) for record in prepared if (record in fitted) is wanted)
        for wanted in (True, False)
    )
    return GrayBox(model, estimate, records, unseen)


def write(job: Job, gray: GrayBox, made: FittedHybrid) -> None:
    """The stage's files, with how much of the network physics could have explained."""
    integrator = gray.estimate.settings.integrator
    explained = tuple(made.hybrid.explained(record, integrator) for record in gray.records)
    found = Residual(
        case=job.settings.case,
        model=made.hybrid.name,
        records=tuple(record.name for record in gray.records),
        provenance=made.hybrid.provenance,
        report=made.report,
        explained=explained,
        warnings=(*made.warnings, *(one.warning for one in explained if one.warning)),
    )
    save_hybrid(made.hybrid, job.folder)
    write_json(job.folder / "residual.json", found)
    if made.estimate is not None:
        write_json(job.folder / "estimate.json", made.estimate)


def check(settings: Settings) -> None:
    """Whether the network can be made as configured.

    Raises:
        ConfigError: if not.
    """
    request, model = request_of(settings), model_of(settings)
    request.check(model)
    least = request.demand(model, (), fit_settings(settings))  # more is known with the records
    check_demand(least, settings)
    if isinstance(request, RBFRequest):
        check_processes(request.processes, "residual.processes", settings)


def asked(settings: Settings) -> bool:
    """Whether the config has a residual network."""
    return settings.get(NAME) is not None


def request_of(settings: Settings) -> Request:
    """The section ``residual``.

    Raises:
        ConfigError: if there is none, or a key or value is not allowed.
    """
    section = settings.get(NAME)
    if not isinstance(section, Mapping) or "kind" not in section:
        given = "no residual network is configured" if section is None else f"residual is {section!r}"
        raise ConfigError(f"{given}: choose residual={' or residual='.join(KINDS)}")
    return KINDS[section["kind"]].of(section)


RESIDUAL = Stage(
    NAME,
    (NAME, "fit.records"),
    ("preprocess", "fit"),
    run,
    inputs=named_code,
    check=check,
    asked=asked,
)
