"""``trace``: finds the physics that the model lacks by refitting it with each effect, and reports it.

Writes ``trace.json``, ``model.json`` (the augmented model), ``report.html`` and ``report.md`` with their
figures, the missing efforts as Parquet, and a proposed law as an effect file.
"""

from __future__ import annotations

import json
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from hybridid.advice.horizon import GROWN, SHORTEST, proposed_horizon
from hybridid.effects.library import effect_named
from hybridid.quantities import quantity
from hybridid.records.record import Record
from hybridid.records.store import load_record
from hybridid.simulation.chosen import EXPLICIT
from hybridid.simulation.stability import MOST
from hybridid.trace.candidates import admissible
from hybridid.trace.horizons.horizon import horizon_for
from hybridid.trace.horizons.split import automatic_horizon, divided
from hybridid.trace.mapper import Report, unheard
from hybridid.trace.results.missing_efforts import Missing
from hybridid.trace.results.result import Trace
from hybridid.validation.drift import growth
from pipelines.shared import modelling
from pipelines.shared.augmented import augmented, by_recording, commands, further_traces
from pipelines.shared.config import Settings
from pipelines.shared.drawing import drawn, fresh_garbage_alone
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import describe_model, fit_of, without_own
from pipelines.shared.imports import code_digests
from pipelines.shared.kept_results import KeptResults, kept_results
from pipelines.shared.limits import check_processes
from pipelines.shared.modelling import fit_settings, groupings_of, model_of, named_code, searched_model_of
from pipelines.shared.one_step import check_one_step
from pipelines.shared.page import Picture
from pipelines.shared.pool import mapper_of
from pipelines.shared.prepared import prepared_records
from pipelines.shared.sources import sources_of
from pipelines.shared.stage import Job, Stage
from pipelines.shared.storage import write_json, write_table
from pipelines.shared.traced import TraceFile
from pipelines.trace.law_file import law_files
from pipelines.trace.page import trace_page
from pipelines.trace.request import (
    Request,
    check_by_recording,
    division,
    fitting_horizon,
    imported_effects,
    is_automatic,
    request_of,
    section_of,
)

FORMATS = ("svg",)
"""Formats of the figures. SVG is enough: the report embeds it, and a browser prints it."""
PATIENCE = 300.0
"""Seconds after which a trace says how it can be ended."""
LONG = (
    "5 minutes so far. Interrupted (Ctrl-C), the same command goes on where it was; with "
    "trace.time_limit=SECONDS it ends after so long, and says what was found by then"
)
INTERRUPTED = "with trace.time_limit=60 it doubts what was found so far and says it (some minutes)"
"""What is said of the same command when a trace is interrupted."""
FOR_PACE = 10
"""Results, the last ones, that tell how fast a stage is."""


def run(job: Job) -> None:
    """Trace the model of the tree, then write the model, the numbers, the figures and the pages."""
    prepared = prepared_records(job.tree)
    asked = request_of(job.settings)
    fitted, held_out = ([load_record(one.file) for one in part] for part in division(prepared, job.settings))
    fit, report = fit_of(job.tree), _Report(job, limited=asked.time_limit is not None)
    estimate = fit.estimate
    for line in (one.said for one in fit.quality.advice if one.kind == "recordings"):
        job.watcher.warn(line)
    request, rate = asked, 0.0
    if is_automatic(job.settings):
        model = model_of(job.settings)
        seconds = horizon_for(model, estimate.values, fitted, held_out, asked.horizon)
        request, rate = replace(asked, horizon=seconds), growth(model, model.values(estimate.values), fitted)
    if line := _other_horizon(request.horizon, asked.horizon, fitted, held_out, rate):
        report.say(line)
    groups = groupings_of(job.settings, model_of(job.settings))
    for line in (line for one in held_out for line in without_own(groups, one.name, estimate)):
        job.watcher.warn(line)
    with kept_results(job.key, job.settings.lone.force, report.say) as keep:
        try:
            found = traced(job.settings, request, fitted, held_out, report, estimate.values, keep, report.say)
        except KeyboardInterrupt as asked_to_end:
            asked_to_end.add_note(INTERRUPTED)
            raise
        found = replace(found, seconds=found.seconds + keep.before)
        for failure in found.shown.failures:
            job.watcher.warn(failure)
        _write(job, found, request.processes)


def _other_horizon(
    horizon: float, usual: float, fitted: Sequence[Record], held_out: Sequence[Record], rate: float = 0.0
) -> str:
    """That and why the horizon [s] has fewer or more samples than the ``usual`` one; else empty. ``rate``
    [1/s] is that at which an error of the model grows."""
    step = fitted[0].dt
    samples, wanted = round(horizon / step), round(usual / step)
    said = f"horizons of {horizon:.3g} s instead of {usual:g} s"
    all_the_same = f"trace.horizon={usual:g} asks for the {{}} ones all the same"
    if samples > wanted:
        why = "so that one shows the slowest dynamics of the fitted model"
        return f"{said}, {why}; {all_the_same.format('shorter')}"
    if samples == wanted:
        return ""
    if rate * usual > GROWN:
        grows = f"since the model is unstable: a small error grows e-fold in {quantity(1 / rate, 's', 2)}"
        return f"{said}, {grows}; {all_the_same.format('longer')}"
    if not _gives_enough(fitted, held_out, usual):
        return f"{said}: these records give too few of the longer ones to judge"
    return f"{said}, so that enough horizons can judge; {all_the_same.format('longer')}"


def _gives_enough(fitted: Sequence[Record], held_out: Sequence[Record], horizon: float) -> bool:
    """Whether the records give enough horizons of that length [s] on either side."""
    try:
        divided(fitted, held_out, horizon)
    except ValueError:
        return False
    return True


def traced(
    settings: Settings,
    request: Request,
    fitted: Sequence[Record],
    held_out: Sequence[Record],
    report: Report,
    start: Mapping[str, float] | None = None,
    keep: KeptResults | None = None,
    say: Callable[[str], None] = unheard,
) -> Trace:
    """What the model of ``settings`` lacks on these records, searched as ``request`` says.

    The first refit starts at the parameters ``start`` (None: at the guesses). ``keep`` stores the results of
    the refits. ``say`` is told what each step decides.
    """
    from hybridid.trace.run import trace  # other commands need not wait for it

    with mapper_of(request.processes) as mapper:
        return trace(
            searched_model_of(settings),
            fitted,
            held_out,
            horizon=request.horizon,
            lengthen=is_automatic(settings),
            effects=request.effects,
            ports=request.ports,
            variables=request.variables,
            rules=request.rules,
            settings=fit_settings(settings),
            start=start,
            initial_state=str(settings["validate.initial_state"]),
            laws=request.laws,
            pairs=request.pairs,
            revise=request.revise,
            recordings=request.by_recording,
            time_limit=request.time_limit,
            mapper=keep(mapper) if keep else mapper,
            report=report,
            say=say,
        )


class _Report:
    """Hands to the watcher how far a trace is, and what it says."""

    def __init__(self, job: Job, limited: bool = False) -> None:
        self._watcher = job.watcher
        self._first = time.monotonic()
        self._ends: deque[float] = deque(maxlen=FOR_PACE + 1)
        self._patient = not limited

    def __call__(self, stage: str, done: int, of: int, what: str) -> None:
        now = time.monotonic()
        if not done:
            self._ends.clear()
        self._ends.append(now)
        last = f", last {what}" if what else ""
        if self._patient and now - self._first >= PATIENCE:
            self._patient = False
            self.say(LONG)
        left = _time_left(stage, now - self._ends[0], len(self._ends) - 1, of - done)
        self._watcher.progress(stage, f"{done} of {of} done{last}{left}", done / of)

    def say(self, line: str) -> None:
        self._watcher.say(f"trace: {line}")


def _time_left(stage: str, elapsed: float, ended: int, left: int) -> str:
    """How long a stage still takes at the pace of its last results, of which so many ``ended`` in the time
    ``elapsed`` [s], where that is a minute or more. The effects of a step begin with the quick ones, so it
    will be longer; pairs with the slow ones."""
    minutes = round(elapsed / ended * left / 60) if ended >= FOR_PACE else 0
    slower = ", more as the slow ones come last" if stage.startswith("step ") else ""
    return f", about {minutes} min left at this pace{slower}" if minutes else ""


def _write(job: Job, found: Trace, processes: int) -> None:
    """Write the model and the numbers, then the figures and the pages, which only show them."""
    settings = _augmented(job.settings, found)
    described = describe_model(settings, model_of(settings), found.provenance)
    write_json(job.folder / "model.json", described)
    _write_missing(job.folder, found.shown.missing)
    samples, model_file = found.shown.split.horizon, job.results / "model.json"
    traced = TraceFile(
        case=job.settings.case,
        processes=processes,
        fitted_records=found.fitted_records,
        commands=(
            *by_recording(job.settings, found.own_values),
            *commands(
                settings, model_file, samples, found.narrowed, found.weights, _own_steps(found), found.horizon
            ),
        ),
        found=found,
        further_traces=further_traces(job.settings, found.cautions),
    )
    write_json(job.folder / "trace.json", traced)
    for name, text in law_files(found, job.settings.case).items():
        (job.folder / name).write_text(text, encoding="utf-8")
    job.watcher.progress("report", "figures and pages", None)
    trace_page(traced, _drawn(job, found)).write(job.folder, "report")


def _own_steps(found: Trace) -> int | None:
    """Steps a sample that RK4 takes for the last model, where a fit would not choose as many by itself."""
    steps = found.estimate.substeps
    return steps if steps > MOST and found.estimate.settings.integrator == EXPLICIT else None


def _write_missing(folder: Path, missing: Missing) -> None:
    """Write ``<record>.<port>.missing_effort.before.parquet`` and ``.after``; the metadata give SI units."""
    for (record, port), efforts in missing.items():
        for when, (model, e) in zip(("before", "after"), efforts.items(), strict=False):
            motion = {name.replace(" ", "_"): values for name, (values, _) in e.motion.items()}
            columns = {"time": e.time, e.kind: e.effort, "std": e.std, **motion}
            about = {
                "record": record, "port": port, "model": model, "provenance": e.provenance,
                "unit": e.unit, "units": {name: unit for name, (_, unit) in e.motion.items()},
            }  # fmt: skip
            notes = {"hybridid": json.dumps(about, ensure_ascii=False)}
            write_table(folder / f"{record}.{port}.missing_effort.{when}.parquet", columns, notes)


def _augmented(settings: Settings, found: Trace) -> Settings:
    """The case's settings with the accepted effects; the user's own effects by their import paths."""
    terms = found.model.terms[len(found.declared) :]
    paths = {effect_named(path).id: path for path in imported_effects(settings)}
    free = replace(found.model, groups={}).free
    return augmented(settings, terms, paths, found.estimate, found.narrowed, free)


def _drawn(job: Job, found: Trace) -> list[Picture]:
    """The figures that can be drawn; the watcher is warned of each that cannot, as of numbers without end."""
    from hybridid.plotting.style import save
    from pipelines.trace.figures import figures  # matplotlib takes half a second to import

    with fresh_garbage_alone():
        return [
            Picture(save(plot, job.folder, name, FORMATS)[0], plot.caption)
            for name, plot in drawn(figures(found), job.watcher)
        ]


def check(settings: Settings) -> None:
    """Check the section ``trace``, and the code of the user's own effects in it.

    Raises:
        ConfigError: if a key or value is wrong, or no effect fits a port of the plant.
        OwnCodeError: if code of an effect to try fails.
    """
    request = request_of(settings)
    check_processes(section_of(settings).processes, "trace.processes", settings)
    fitted, held_out = division(sources_of(settings).found, settings)
    check_by_recording(section_of(settings), fitted, held_out)
    model = model_of(settings)
    for grouping in groupings_of(settings, model):
        grouping.check_fitted([one.name for one in fitted], "trace.records")
    kinds = {port.kind for port in model.plant.ports}
    if not any(effect.kind in kinds for effect in request.effects):
        raise ConfigError(f"trace.effects: plant {model.plant.name} has no port where any of them acts")
    own = [effect_named(path) for path in imported_effects(settings)]
    for candidate in admissible(model, own, request.ports):
        _ = candidate.added_to(model).f  # asks the effect for its equations


def check_records(settings: Settings, tree: Path) -> None:
    """Check that the records have one sampling time, and that a horizon holds samples: a trace would end with
    that after the fit.

    Raises:
        ConfigError: if not; the message says which keys and which horizon would do.
    """
    prepared = prepared_records(tree)
    fitted, held_out = division(prepared, settings)
    check_one_step([*fitted, *held_out])
    horizon, first = fitting_horizon(request_of(settings), prepared, settings).horizon, fitted[0]
    if round(horizon / first.dt) < SHORTEST:
        ours, theirs = ([record.seconds for record in part] for part in (fitted, held_out))
        proposed = automatic_horizon(ours, theirs, proposed_horizon(first.dt, min(ours)), step=first.dt)
        raise ConfigError(
            f"trace.horizon is {horizon:g} s: record {first.name} is sampled every {first.dt:.6g} s, a "
            f"horizon needs at least {SHORTEST} samples; trace.horizon={proposed:.2g} is proposed"
        )


TRACE = Stage(
    "trace",
    (*modelling.KEYS, "estimator", "trace", "validate.horizon", "validate.initial_state"),
    ("preprocess", "fit"),
    run,
    inputs=lambda settings: {**named_code(settings), **code_digests(imported_effects(settings))},
    check=check,
    check_records=check_records,
    side_by_side=True,
    moves_nothing=("trace.processes",),
)
