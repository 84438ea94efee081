"""Accepted delays and lags that may be those of the recording.

Of no more than half a sample: the record's sampling may make as much.

A signal that is held (zero-order hold) lags one that goes straight from sample to sample (first-order hold)
by half a sample, and so does a time stamp taken at the end of a sample instead of its middle. So what is
delayed by that much or less may be the declaration of the hold or of the time stamps, and not the machine.

Source: Franklin, Powell, Workman (1998), Digital Control of Dynamic Systems, 3rd ed., sec. 4.3.1.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from hybridid.effects.delay import INPUT_DELAY
from hybridid.effects.dimension import TIME
from hybridid.effects.effect import Effect
from hybridid.effects.paths import INPUT_RECORD_LAG
from hybridid.effects.sampled import PATHS
from hybridid.naming import listed
from hybridid.quantities import quantity
from hybridid.trace.candidates import Candidate
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.search.steps import Accepted


def within_half_a_sample(accepted: Sequence[Accepted], final: Refit, dt: float) -> str:
    """That the sampling every ``dt`` s may make as much as an accepted delay or lag, in words; empty where
    each is longer than half a sample in the ``final`` model, by more than two standard errors."""
    short = [told for one in accepted for told in _short_times(one.trial.candidate, final, dt / 2)]
    if not short:
        return ""
    return (
        f" Beware: {listed(short)} may be no more than half a sampling period ({quantity(dt / 2, 's', 3)}). "
        "The hold of the input or the record's time stamps make as much, if they are not as declared."
    )


def recorded_late(accepted: Sequence[Accepted]) -> str:
    """That the inputs may have been recorded late, where an accepted effect or one of its class says so: a
    fault to look for before all else. Else empty."""
    late = _members(accepted, INPUT_RECORD_LAG)
    if not late:
        return ""
    return (
        f" Beware: {listed(late)} says that the machine answers before it is driven. That is a fault "
        "of the recording: a filter, an amplifier or a clock in one channel. Look for it first, mend it, and "
        "trace again: other names may only make up for it."
    )


def outputs_late(accepted: Sequence[Accepted]) -> str:
    """That the outputs may have been stamped late instead, where an input is found to be delayed; else empty.
    A machine whose equations do not change with time moves the same, if all of it is recorded later."""
    late = _members(accepted, INPUT_DELAY)
    if not late:
        return ""
    return (
        f" Beware: {listed(late)} may as well be a delay of the outputs: sensors whose samples are "
        "stamped late (a camera, a bus, a filter of constant delay) look the same."
    )


def _members(accepted: Sequence[Accepted], effect: Effect) -> list[str]:
    """Where ``effect`` was accepted, or is in the class of what was, by its names."""
    members = [trial.candidate for one in accepted for trial in (one.trial, *one.alike)]
    return list(dict.fromkeys(one.name for one in members if one.effect.id == effect.id))


def _short_times(candidate: Candidate, found: Refit, half: float) -> Iterator[str]:
    """The times of the effect's path that are not clearly longer than ``half`` [s], in words. Of a long one
    whose interval includes zero, the records say nothing, and that is told elsewhere."""
    if candidate.effect.kind not in PATHS:
        return
    for p in candidate.effect.parameters:
        name = f"{candidate.name}.{p.name}"
        if not (p.nests and p.dimension == TIME):
            continue
        value = found.values[name]
        if value <= half or 0.0 < value - 2 * found.std.get(name, 0.0) <= half:
            yield f"the {p.name} of {candidate.name}"
