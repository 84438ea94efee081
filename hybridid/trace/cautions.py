"""What speaks against taking a verdict at its word, told behind it."""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.advice.decay import free_decay
from hybridid.naming import listed
from hybridid.records.record import Record
from hybridid.trace.context import Context
from hybridid.trace.decay_class import in_their_place
from hybridid.trace.doubted import revision_advised
from hybridid.trace.entries import AcceptedEffect
from hybridid.trace.free_run import worse_in_free_run
from hybridid.trace.horizon_advice import other_horizons_advised, parts_of_all_advised
from hybridid.trace.hystereses import several_hystereses
from hybridid.trace.idle import SURE
from hybridid.trace.one_way import judged_the_other_way
from hybridid.trace.result import Trace
from hybridid.trace.sampling import within_half_a_sample
from hybridid.trace.steps import Accepted
from hybridid.trace.verdict import Conclusion


def cautions(found: Conclusion, traced: Trace, records: Sequence[Record], context: Context) -> str:
    """Sentences for the trace of the fitted ``records``, each after a space; empty if there is none."""
    told = [revision_advised(found, context), several_hystereses(found.accepted)]
    told += [judged_the_other_way(found.search.first, context)]
    told += [within_half_a_sample(found.accepted, found.search.final, records[0].dt)]
    if found.verdict == "unexplained":
        told += [other_horizons_advised(found.search.final, context.split)]
    if found.verdict == "undecided" and traced.steady is None and traced.longer is None:
        told += [parts_of_all_advised(context.split)]
    if traced.accepted:
        told += [not_told_from_zero(found.accepted, traced.accepted), _confounded(records)]
        told += [in_their_place(found.search)]
    return "".join([*told, worse_in_free_run(traced)])


def not_told_from_zero(accepted: Sequence[Accepted], entries: Sequence[AcceptedEffect]) -> str:
    """Of which accepted effects the interval includes zero, in words; empty if of none.

    An effect that was determined when it was accepted may not be so beside those that followed. A limit that
    is hard has no interval on the side of infinity.
    """
    amplitudes = {
        one.name: [p.name for p in one.trial.candidate.effect.parameters if p.nests and not p.fixed]
        for one in accepted
        if not any(p.hard for p in one.trial.candidate.effect.parameters)
    }
    unsure = [
        entry.name
        for entry in entries
        if amplitudes.get(entry.name)
        and all(
            abs(entry.parameters[name].value) <= SURE * entry.parameters[name].std
            for name in amplitudes[entry.name]
        )
    ]
    if not unsure:
        return ""
    its = "their intervals include" if len(unsure) > 1 else "its interval includes"
    return f" Beware: beside all others these records hardly show {listed(unsure)}: {its} zero."


def _confounded(records: Sequence[Record]) -> str:
    """That a name may stand for another one, where all records are one free decay; else empty."""
    return "".join(f" Beware: {one.said}." for one in free_decay(records))
