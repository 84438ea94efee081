"""The figures of a fitted and validated model, each with the name of its file.

This is not in the module of the stage ``plot``: importing matplotlib takes half a second, and not every
process draws.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from hybridid.model import Model
from hybridid.plotting.comparison import comparison_plot
from hybridid.plotting.error import error_plot
from hybridid.plotting.loop import loop_plot
from hybridid.plotting.parameters import parameters_plot
from hybridid.plotting.raincloud import raincloud_plot
from hybridid.plotting.record import record_plot
from hybridid.plotting.residual_correlation import residual_correlation_plot
from hybridid.plotting.series import Response
from hybridid.plotting.spectrum import spectrum_plot
from hybridid.plotting.style import Plot
from hybridid.records.record import Record
from hybridid.records.store import load_record
from pipelines.plot.choice import Choice
from pipelines.plot.laws import Law, friction_plots, laws_of
from pipelines.shared.fitted import Fit, fit_of, fitted_model
from pipelines.shared.predictions import Stored, Tested, predictions_in, residual_tests_in
from pipelines.shared.stage import Job

LOOP = "loop"
"""The view that has a figure of its own."""
Named = Iterator[tuple[str, Callable[[], Plot]]]


def figures(job: Job, choice: Choice) -> Named:
    """What draws each figure of the chosen records and of the model, with its file's name
    ``<record>.<output or port>.<figure>``. It pickles."""
    model, _ = fitted_model(job.settings, job.tree)
    laws = laws_of(job.settings, job.tree)
    everything = predictions_in(job.tree)
    stored = [s for s in everything if s.prediction.view != LOOP]
    tests = residual_tests_in(job.tree)
    for prepared in choice.all_figures:
        record = load_record(prepared.file)
        job.watcher.progress("plot", f"record {record.name}", None)
        yield f"{record.name}.record", partial(record_plot, record)
        own = [s for s in stored if s.prediction.record == record.name]
        yield from _of_record(laws, record, own, tests)
        yield from _in_loop(
            record, [s for s in everything if (s.prediction.record, s.prediction.view) == (record.name, LOOP)]
        )
    for prepared in choice.compared:
        yield from _comparisons(prepared.name, stored)
    shown = {prepared.name for prepared in (*choice.all_figures, *choice.compared)}
    yield from _of_model(model, [s for s in stored if s.prediction.record in shown], fit_of(job.tree))


def _of_record(
    laws: Sequence[Law], record: Record, stored: Sequence[Stored], tests: Sequence[Tested]
) -> Named:
    """Figures of one record: each output in every view, and each port."""
    if not stored:
        return
    for output in (channel.name for channel in record.output_channels):
        responses = [Response.of(s.model, s.prediction, output) for s in stored]
        free = [r for s, r in zip(stored, responses, strict=True) if s.horizon is None]
        stem = f"{record.name}.{output}"
        yield f"{stem}.comparison", partial(comparison_plot, responses)
        yield f"{stem}.error", partial(error_plot, responses)
        # the jumps between horizons would show at all frequencies
        yield f"{stem}.spectrum", partial(spectrum_plot, free or responses)
        for test in tests:
            if (test.found.record, test.found.output) == (record.name, output):
                kind = "residual" if test.model == laws[0].name else "hybrid.residual"
                draw = partial(residual_correlation_plot, test.model, test.found)
                yield f"{stem}.{kind}.{test.view}", draw
    for port, draw_friction in friction_plots(laws, record, stored):
        yield f"{record.name}.{port.name}.friction", draw_friction


def _comparisons(record: str, stored: Sequence[Stored]) -> Named:
    """The figures of one record that hold the model against the data, one for each output."""
    own = [s for s in stored if s.prediction.record == record]
    for output in own[0].prediction.output_names if own else ():
        responses = [Response.of(s.model, s.prediction, output) for s in own]
        yield f"{record}.{output}.comparison", partial(comparison_plot, responses)


def _in_loop(record: Record, stored: Sequence[Stored]) -> Named:
    """The figure of one record under the control law."""
    if stored:
        names = stored[0].prediction.output_names
        signals = [[Response.of(s.model, s.prediction, name) for s in stored] for name in names]
        yield f"{record.name}.loop", partial(loop_plot, signals)


def _of_model(model: Model, stored: Sequence[Stored], fit: Fit) -> Named:
    """Figures over several records: the spread of the errors of those that are drawn, the estimates."""
    for output in model.outputs if stored else ():
        responses = [Response.of(s.model, s.prediction, output.name) for s in stored]
        yield f"{output.name}.raincloud", partial(raincloud_plot, responses)
    fitted = ", ".join(fit.records)
    estimates = {fit.model: fit.estimate}
    yield "parameters", partial(parameters_plot, estimates, model.parameters, fitted, fit.provenance)
