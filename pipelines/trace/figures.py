"""The figures of a trace: waterfall, trials, residual before and after, missing effort, ceilings."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from hybridid.plotting.error import error_plot
from hybridid.plotting.series import Response
from hybridid.plotting.style import Plot
from hybridid.plotting.trace_ceiling import LearnedCurve, ceiling_plot
from hybridid.plotting.trace_law import law_plot
from hybridid.plotting.trace_missing_effort import missing_effort_plot
from hybridid.plotting.trace_trials import Tried, trials_plot
from hybridid.plotting.trace_waterfall import Level, waterfall_plot
from hybridid.records.record import Record
from hybridid.trace.entries import StepTaken
from hybridid.trace.learned.ceiling import Ceiling
from hybridid.trace.results.result import Trace

Named = Iterator[tuple[str, Callable[[], Plot]]]


def figures(found: Trace) -> Named:
    """Every figure of a trace: the name of its file, and the call that draws it."""
    yield from waterfalls(found)
    for number, step in enumerate(found.steps, 1):
        if step.trials:
            name, worth = f"step {number}", found.rules.worth
            yield (
                f"step{number}.trials",
                partial(trials_plot, _tried(step), worth, name, found.judged, found.provenance),
            )
    for record in found.shown.split.records:
        yield from _errors(found, record)
    yield from _missing(found)
    yield from _ceilings(found)
    yield from _laws(found)


def waterfalls(found: Trace) -> Named:
    """The held-out error of each output for each model of the search, from the declared to the last."""
    for output, floor in found.noise_floor.items():
        levels = [Level(entry.label, entry.held_out_rmse[output]) for entry in found.path]
        shown = levels, floor.value, output, floor.unit, found.judged, found.provenance
        yield f"{output}.waterfall", partial(waterfall_plot, *shown)


def _tried(step: StepTaken) -> list[Tried]:
    taken = " + ".join(step.taken)
    tried = [(t.name, t.gain, t.status) for t in step.trials]
    tried += [(pair.name, pair.gain, pair.status) for pair in step.pairs]
    return [Tried(name, gain, "accepted" if name == taken else status) for name, gain, status in tried]


def _errors(found: Trace, record: Record) -> Named:
    """The errors over horizons, because the search judges models by these."""
    shown = [(m.name, over) for m in found.shown.models if (over := m.over_horizons(record.name)) is not None]
    for output in found.noise_floor if shown else ():
        responses = [Response.of(name, over, output) for name, over in shown]
        yield f"{record.name}.{output}.error", partial(error_plot, responses)


def _missing(found: Trace) -> Named:
    by_name = {record.name: record for record in found.shown.split.records}
    for (name, port), efforts in found.shown.missing.items():
        record = by_name[name]
        inputs = {
            channel.name: (np.asarray(record.inputs[:, k]), channel.unit)
            for k, channel in enumerate(record.input_channels)
            if not channel.constant
        }
        yield f"{name}.{port}.missing_effort", partial(missing_effort_plot, efforts, inputs)


def _ceilings(found: Trace) -> Named:
    """The learned effort over one variable beside each model, a figure for each port; and one for each factor
    with which a learned effort takes a share worth having."""
    curves = [
        (one.port, one.over.factor, _curve(model.name, one))
        for model, of_model in zip(found.shown.models, found.shown.ceilings, strict=True)
        for one in of_model
        if one.curve
    ]
    for port, factor in dict.fromkeys((port, factor) for port, factor, _ in curves):
        own = [curve for *place, curve in curves if place == [port, factor]]
        times = f".times_{factor}".replace(" ", "_") if factor else ""
        if not factor or max(curve.gain for curve in own) >= found.rules.worth:
            yield f"{port}{times}.ceiling", partial(ceiling_plot, port, own, found.judged, found.provenance)


def _laws(found: Trace) -> Named:
    """Each proposed law over the learned effort that it explains."""
    for one in found.shown.conclusion.accepted:
        if one.drawn is not None:
            law, learned = one.drawn.curve, one.drawn.learned
            yield (
                f"{one.name}.law",
                partial(
                    law_plot,
                    one.drawn.port,
                    one.trial.candidate.effect.equation,
                    (law.at, law.value),
                    (learned.at, learned.value, learned.samples),
                    (one.drawn.over_unit, one.drawn.unit),
                    one.drawn.over.name,
                    one.drawn.value,
                    one.drawn.over.factor,
                    found.provenance,
                ),
            )


def _curve(model: str, one: Ceiling) -> LearnedCurve:
    at, effort, samples = np.array(one.curve, dtype=float).T
    units = one.unit, one.over_unit
    return LearnedCurve(
        model,
        one.over.name,
        at,
        effort,
        samples,
        *units,
        one.gain,
        one.refit.ended_early,
        one.kind,
        one.over.factor,
    )
