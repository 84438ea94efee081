"""``trace``: a model and records in, a ``Trace`` out; nothing is printed and no file is touched."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from hybridid.advice.disagreement import Disagreement
from hybridid.effects.effect import Effect
from hybridid.effects.library import effect_named, library_for
from hybridid.effects.sampled import sampled
from hybridid.effects.variable import Variable
from hybridid.estimators import FitSettings
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.settings.choices import AskedIntegrator
from hybridid.simulation.chosen import AUTO, EXPLICIT, as_integrator
from hybridid.trace.cautions.cautions import cautions, marked_as_shown
from hybridid.trace.cautions.constants import WrongConstants, wrong_constants
from hybridid.trace.cautions.decay_class import with_decay_classes
from hybridid.trace.cautions.doubted import in_doubt
from hybridid.trace.context import Context
from hybridid.trace.entries import DifferingParameter
from hybridid.trace.horizons.horizon import horizon_for
from hybridid.trace.horizons.split import check_measured, divided
from hybridid.trace.mapper import Mapper, Report, serial, silent, unheard
from hybridid.trace.noise_floor.input_noise import NoiseLevel
from hybridid.trace.noise_floor.weighed import hidden_by_noise, weights_in_words, with_noise
from hybridid.trace.over_longer import concluded
from hybridid.trace.recordings.between_recordings import disagreeing, own_values_suffice
from hybridid.trace.recordings.by_recording import by_recording, check_split
from hybridid.trace.refits.declared_starts import declared_starts
from hybridid.trace.refits.numerics import numerics_for
from hybridid.trace.results.before_after import FittedModel, Validation, before_and_after
from hybridid.trace.results.completeness import ceilings_of_each, with_networks
from hybridid.trace.results.missing_efforts import missing_efforts
from hybridid.trace.results.result import Evidence, Trace
from hybridid.trace.rules import PAIRS, Rules
from hybridid.trace.search.sharper import narrowed
from hybridid.trace.search.steps import OUT_OF_TIME
from hybridid.trace.starts.solve import declared_refit
from hybridid.trace.trials.trial import PASSED
from hybridid.trace.verdict import Conclusion
from hybridid.trace.words.summary import summary
from hybridid.trace.words.told_classes import as_told
from hybridid.trace.words.words import sentence

NAMED = ("effect_found", "law_proposed")
"""Verdicts that recordings which differ leave in doubt."""
OPEN = ("nothing_missing", "undecided")
"""Verdicts that a parameter contradicts which differs by recording."""


def trace(
    model: Model,
    records: Sequence[Record],
    held_out: Sequence[Record] = (),
    *,
    horizon: float | None = None,
    lengthen: bool | None = None,
    effects: Sequence[Effect | str] | None = None,
    ports: Sequence[str] | None = None,
    variables: Sequence[Variable] | None = None,
    rules: Rules | None = None,
    settings: FitSettings | None = None,
    start: Mapping[str, float] | None = None,
    initial_state: str = "estimated",
    laws: bool = True,
    pairs: int = PAIRS,
    revise: bool = False,
    recordings: bool | None = None,
    time_limit: float | None = None,
    mapper: Mapper = serial,
    report: Report = silent,
    say: Callable[[str], None] = unheard,
) -> Trace:
    """Find what ``model`` lacks on ``records``, judged on the records ``held_out``.

    Without any, alternate horizons of ``records`` judge. ``horizon`` is the length of each in s (None: 1
    s, more where the model's dynamics are slower, less where the records are short). Where nothing is
    found and longer horizons leave more, the search goes on over these, if it may ``lengthen`` them
    (None: if ``horizon`` is None). ``effects`` (None: the library; a name: that effect of the library)
    are tried at every port of their kind, or only at ``ports``, by ``rules``. Learned efforts and laws
    depend on ``variables`` (None: all that a port has). ``settings`` are those of the fits before and
    after, and give the integrator; ``start`` (values by name; None: by regression) is where the declared
    model starts. ``initial_state`` ("estimated" or "measured") is that of free runs. Where no effect
    explains what is missing, ``pairs`` of effects are tried, the most promising ones (0: none); with
    ``laws``, a law is composed. With ``revise``, each declared effect is left out in turn, and others are
    sought in its place. With ``recordings``, each parameter is tried with a value for each record; if it
    is None, and one or two parameters with values of their own leave no more than noise, one effect alone
    is sought that does as well. No step begins that would end after ``time_limit`` s (None: no limit),
    should it take as long as the one before, and after that no effect, pairs, laws or revision. At least
    five effects are tried; a step that leaves one out gives no name. What was accepted is doubted as
    always. Of a sample at which one output was not measured the others count.
    ``mapper`` runs the refits, one after another or side by side; ``report`` follows them. ``say`` is told
    what each step decides, as it falls.

    Raises:
        ValueError: if the library has no effect of a name in ``effects``; a record does not fit the model,
            the model diverges on the records, they give too few horizons for a verdict, or an output was
            measured in too few of them; with ``recordings``, if there is one record or a record is held out.
    """
    began = time.perf_counter()
    fitted, others = tuple(records), tuple(held_out)
    seconds = horizon or horizon_for(model, start, fitted, others)
    split = divided(fitted, others, seconds)
    check_measured(split)
    if recordings:
        check_split(split)
    tried = library_for(model.channels) if effects is None else _known(effects, model)
    tried = sampled(tried, fitted[0].dt)
    where = None if ports is None else tuple(ports)
    over = None if variables is None else tuple(variables)
    until = math.inf if time_limit is None else time.monotonic() + time_limit
    asked = (where, mapper, report, say, laws, pairs, revise, over, until)
    context = Context(split, tried, rules or Rules(), *asked)
    settings = replace(settings or FitSettings(), method="gauss_newton", horizon=split.horizon)
    if recordings is None:
        context = replace(context, own_values=own_values_suffice(model, fitted, settings, start))
    begun = [start] if start else []
    weights = _weights(model, context, begun, settings.integrator)
    if weights:
        fitted, others = with_noise(fitted, weights), with_noise(others, weights)
        context = replace(context, split=divided(fitted, others, seconds))
        context.say(weights_in_words(weights).strip())
    may_lengthen = horizon is None if lengthen is None else lengthen
    found, context = concluded(model, context, begun, settings.integrator, may_lengthen)
    found = _of_one_decay(found, fitted, context)
    differ = by_recording(found.search, context) if recordings else ()
    if any(one.status == PASSED for one in differ):
        found = _contradicted(found)
    constants = wrong_constants(found, context)
    found = _doubted(found, differ, constants, context)
    if context.split.horizon != split.horizon:
        seconds = context.split.horizon * fitted[0].dt
    solving = _solving(found.search.first.numerics.integrator)
    settings = replace(settings, integrator=solving, horizon=context.split.horizon)
    validation = Validation(fitted, others, settings, seconds, initial_state)
    models = before_and_after(found, validation, context)
    apart = None if recordings else disagreeing(models, validation)
    found = _unless_apart(found, apart)
    evidence = _evidence(found, models, validation, context)
    traced = replace(
        summary(evidence, context.rules, validation, time.perf_counter() - began),
        by_recording=differ,
        narrowed=narrowed(model, found.model),
        finer=found.search.final.numerics.finer,
        weights=weights,
    )
    traced = marked_as_shown(found.accepted, traced)
    if apart:
        traced = replace(traced, disagreement=apart.said, own_values=apart.settings)
    if found.out_of_time:
        traced = replace(traced, time_limit=time_limit, stopped=OUT_OF_TIME)
    beware = cautions(found, traced, fitted, constants, context)
    return replace(traced, sentence=sentence(traced), cautions=beware)


def _doubted(
    found: Conclusion, differ: Sequence[DifferingParameter], constants: WrongConstants, context: Context
) -> Conclusion:
    """``found``, in doubt where parameters that ``differ`` by recording or declared ``constants`` explain as
    much, with the classes that are told."""
    freed = {name for one in constants.in_place for name in one.instead}
    if in_doubt(found, freed | {one.in_place_of for one in differ}, context):
        found = replace(found, verdict="ambiguous")
    return replace(found, search=replace(found.search, accepted=as_told(found.search, context)))


def _unless_apart(found: Conclusion, apart: Disagreement | None) -> Conclusion:
    """``found``; in doubt or contradicted where the recordings are ``apart``."""
    if apart is None:
        return found
    return replace(found, verdict="ambiguous") if found.verdict in NAMED else _contradicted(found)


def _contradicted(found: Conclusion) -> Conclusion:
    """``found``, whose verdict a parameter that differs by recording contradicts, unless something was
    accepted."""
    open_still = found.verdict in OPEN and not found.accepted
    return replace(found, verdict="unexplained") if open_still else found


def _evidence(
    found: Conclusion, models: Sequence[FittedModel], validation: Validation, context: Context
) -> Evidence:
    """All that a report shows of ``found``: the models before and after, and what learned efforts, networks
    and missing efforts say beside them. Whether a model is complete is no question after a time limit."""
    ceilings = ceilings_of_each(found, context)
    networks = [] if found.out_of_time else with_networks(models, ceilings, validation, context)
    missing, failures = missing_efforts(models, context.split.records, context)
    return Evidence(context.split, found, tuple(models), ceilings, tuple(networks), missing, failures)


def _weights(
    model: Model, context: Context, start: Sequence[Mapping[str, float]], integrator: AskedIntegrator
) -> dict[str, NoiseLevel]:
    """The noise by which the outputs must count beside the declared model, by name; none if they need not."""
    if len(model.outputs) < 2:
        return {}
    starts = declared_starts(model, context.split, start)
    numerics = numerics_for(model, context.split, starts, integrator)
    return hidden_by_noise(declared_refit(model, context, starts, numerics), context)


def _solving(searched_with: str) -> AskedIntegrator:
    """What solves the models before and after: the integrator of the search, but where that is RK4, the
    implicit one for a model that is too stiff for it. An accepted effect may make a model stiff."""
    return AUTO if searched_with == EXPLICIT else as_integrator(searched_with)


def _known(effects: Sequence[Effect | str], model: Model) -> tuple[Effect, ...]:
    """``effects``, those of the library by their names."""
    return tuple(effect_named(one, model.channels) if isinstance(one, str) else one for one in effects)


def _of_one_decay(found: Conclusion, records: Sequence[Record], context: Context) -> Conclusion:
    """``found`` with frictions over the amplitude and over the time in one class, where these are one."""
    searched = with_decay_classes(found.search, records, context)
    several = any(len(one.alike) > 1 for one in searched.accepted)
    ambiguous = found.verdict == "effect_found" and several
    return replace(found, search=searched, verdict="ambiguous" if ambiguous else found.verdict)
