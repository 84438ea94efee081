"""What a trace says of a search that the time limit ended."""

from __future__ import annotations

from hybridid.naming import counted
from hybridid.quantities import share
from hybridid.trace.entries import StepTaken, TriedEffect
from hybridid.trace.results.result import Trace
from hybridid.trace.trials.trial import PASSED
from hybridid.trace.words.remarks import none_of, parameters_in_words


def cut_short(found: Trace) -> str:
    """That the time limit ended the search, and when; empty if it did not."""
    if found.time_limit is None:
        return ""
    where = f"after {counted(len(found.steps), 'step')}"
    if last := cut_step(found):
        left, every = len(last.left_out), len(last.left_out) + len(last.trials)
        where = f"in step {len(found.steps)} and left {left} of {every} effects untried"
    return (
        f"The time limit of {found.time_limit:g} s ended the search {where}: the verdict holds for what was "
        "tried by then. A larger trace.time_limit goes on from there. "
    )


def cut_step(found: Trace) -> StepTaken | None:
    """The last step, if the time limit left out effects of it."""
    return found.steps[-1] if found.steps and found.steps[-1].left_out else None


def passed_in(step: StepTaken) -> list[TriedEffect]:
    """The effects of a step that passed."""
    return [one for one in step.trials if one.status == PASSED]


def best_tried(step: StepTaken) -> str:
    """What explains most of a step that the time limit ended; one of the others may explain more."""
    passed = passed_in(step)
    if not passed:
        return f"{none_of(len(step.trials), 'explain')} the error"
    best = max(passed, key=lambda one: one.gain)
    told = ", ".join(parameters_in_words(best.parameters))
    return (
        f"{best.effect} at {best.port} ({told}) takes {share(best.gain)}, which is no name while others are "
        "untried,"
    )
