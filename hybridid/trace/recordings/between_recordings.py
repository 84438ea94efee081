"""What may differ between the recordings, told behind a verdict.

A search gives all recordings the same parameters. Where these differ, in load or in friction, it may name
effects for that. So where the declared model leaves more than noise and simulation, its fit is repeated with
values of its own for each recording (``hybridid.advice.disagreement``). What that leaves is told if it is no
more than the last model of the trace leaves of the same recordings. Then no name is sure.

Where values of their own for one or two parameters ``suffice``, so that no more than noise and simulation is
left, one effect is tried in their place. If none leaves as little, the search ends there: several effects
together are more physics than one load that was changed. The user may say that nothing was changed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from hybridid.advice.disagreement import LEFT, Disagreement, disagreement, share_left
from hybridid.estimators.fit import fit
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.settings.fit import FitSettings
from hybridid.trace.context import Context
from hybridid.trace.recordings.other_parameters import ASK, other_parameters, recordings
from hybridid.trace.recordings.recording_offset import offset_by_recording
from hybridid.trace.results.before_after import FittedModel, Validation
from hybridid.trace.search.steps import Search
from hybridid.trace.trials.constancy import NO_CONSTANT
from hybridid.trace.verdict import Conclusion


def disagreeing(models: Sequence[FittedModel], validation: Validation) -> Disagreement | None:
    """Which parameters differ between the fitted recordings, if values of their own leave no more than the
    last of ``models`` does, which are those before and after the trace; else None."""
    before, after = models[0], models[-1]
    if len(validation.fitted) < 2:
        return None
    most = min(LEFT, share_left([after.estimate], before.estimate))
    return disagreement(before.model, validation.fitted, before.estimate, most)


def own_values_suffice(
    model: Model, records: Sequence[Record], settings: FitSettings, start: Mapping[str, float] | None
) -> bool:
    """Whether one or two parameters of ``model`` with a value for each of ``records`` leave no more than
    noise and simulation, where one value for all leaves more."""
    if len(records) < 2:
        return False
    try:
        estimate = fit(model, records, replace(settings, starts=1), start_values=start)
        found = disagreement(model, records, estimate)
    except ValueError:  # what cannot be fitted is told by the search
        return False
    return found is not None and found.suffices


def between_recordings(found: Conclusion, context: Context) -> list[str]:
    """What may differ between the recordings, where the sentence does not begin with it: something is
    unexplained, or far more than the noise is left beside what was accepted. If it is so, nothing else that
    is told counts as much."""
    final = found.search.final
    if found.verdict == "unexplained":
        return [
            _of_recordings(found.search, context),
            offset_by_recording(final, context.split, context.rules),
        ]
    far = found.accepted and found.times > context.rules.far
    return [other_parameters(final, context)] if far else []


def _of_recordings(found: Search, context: Context) -> str:
    """That a parameter may differ between the recordings, and how to ask which; empty if nothing says so."""
    return other_parameters(found.final, context) or _may_differ_by_recording(found, context)


def _may_differ_by_recording(found: Search, context: Context) -> str:
    """How to ask what differs by recording, where an effect was refused as its amplitude is another one in
    the held-out records; else empty. Parts of one file are one recording."""
    reasons = [found.withdrawn, *(trial.reason for step in found.steps for trial in step.trials)]
    if len(recordings(context.split.records)) < 2 or not any(NO_CONSTANT in reason for reason in reasons):
        return ""
    return ASK
