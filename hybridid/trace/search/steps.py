"""What a search has done: the effects that were accepted, its steps, and the path that they make."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from hybridid.effects.over import Over
from hybridid.naming import counted
from hybridid.trace.learned.ceiling import Ceiling
from hybridid.trace.learned.law_curve import LawOverLearned
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.trials.pair import PairTrial
from hybridid.trace.trials.robustness import Survival
from hybridid.trace.trials.trial import Trial

WITHDRAWN = "may stand in for something else"
"""How the reason begins why an effect that had passed is no name."""
AT_FLOOR, NONE_PASSES = "the residual meets the noise floor", "no further effect passes"
NO_ROOM = "the residual is so near the sensors' noise that no effect could take what is worth having from it"
OUT_OF_TIME = "the time limit was reached"
RECORDINGS_DIFFER = "values of their own for each recording leave less than any effect alone"
AT_SIMULATION = "the residual is no more than the sensors' noise and the error of the simulation"
AT_FLOOR_TOGETHER = "fitted to all horizons together, the model leaves no more than the sensors' noise"


@dataclass(frozen=True)
class Accepted:
    """An effect taken into the model, with those the records cannot tell from it.

    A composed law is also ``drawn`` over the learned effort that it explains. Of a pair, ``together`` names
    the other effect; the trial is then the one beside it.
    """

    trial: Trial
    alike: tuple[Trial, ...]
    survivals: tuple[Survival, ...]
    drawn: LawOverLearned | None = None
    together: str = ""

    @property
    def name(self) -> str:
        """``port.effect`` of the accepted effect."""
        return self.trial.candidate.name


@dataclass(frozen=True)
class Step:
    """One forward step: what the model was, every trial, and what was taken, if anything.

    Where no effect passed, ``pairs`` may have been refitted, of ``family`` that could be formed. Of a pair
    that was taken, ``accepted`` is the first effect and ``together`` the second. ``learned`` are the learned
    efforts beside ``base``, where the step was held against them. ``minor`` says why an effect that passed is
    no name beside one of them. ``left_out`` names the effects that the time limit left untried; then none is
    accepted.
    """

    base: Refit
    trials: tuple[Trial, ...]
    accepted: Accepted | None
    dropped: tuple[str, ...] = ()
    pairs: tuple[PairTrial, ...] = ()
    family: int = 0
    together: Accepted | None = None
    learned: tuple[Ceiling, ...] = ()
    minor: str = ""
    left_out: tuple[str, ...] = ()

    @property
    def taken(self) -> tuple[Accepted, ...]:
        """What was accepted: nothing, an effect, or a pair."""
        return tuple(one for one in (self.accepted, self.together) if one is not None)

    @property
    def loss(self) -> float:
        """The held-out loss with the effect that was accepted; infinite if none was."""
        refitted = self.accepted.trial.refit if self.accepted else None
        return refitted.score.loss if refitted else math.inf


@dataclass(frozen=True)
class Search:
    """The path from the declared model to the last; ``stopped`` says why it ended.

    ``withdrawn`` says why an effect that had passed was withdrawn afterwards, if one was. ``refused_laws``
    are the composed laws, of ``laws_formed``, that were tried beside the last model; none of them passed.
    ``other_laws`` are the ports and variables of which another law than a name withdrawn is known to explain
    more; ``in_place_of`` are the effects that were accepted first, and whose place a law has taken.
    """

    steps: tuple[Step, ...]
    final: Refit
    accepted: tuple[Accepted, ...]
    stopped: str
    withdrawn: str = ""
    refused_laws: tuple[Trial, ...] = ()
    laws_formed: int = 0
    other_laws: tuple[tuple[str, Over], ...] = ()
    in_place_of: tuple[str, ...] = ()

    @property
    def first(self) -> Refit:
        """The declared model as it was first fitted."""
        return self.steps[0].base if self.steps else self.final

    @property
    def at_noise(self) -> bool:
        """Whether it ended at the sensors' noise."""
        return self.stopped in (AT_FLOOR, AT_FLOOR_TOGETHER, AT_SIMULATION, NO_ROOM)

    @property
    def cut_within_a_step(self) -> bool:
        """Whether the time limit left out effects of the last step."""
        return bool(self.steps and self.steps[-1].left_out)

    @property
    def before_any(self) -> Search:
        """The search as if its first step had accepted nothing."""
        first = replace(self.steps[0], accepted=None, together=None, dropped=())
        return replace(
            self, steps=(first,), final=first.base, accepted=(), withdrawn="", refused_laws=(), laws_formed=0
        )


Back = tuple[list[Step], Refit, list[Accepted]]
"""Where a search goes on that went back: its steps, the last model, and the effects that this holds."""


def back_at(steps: list[Step]) -> Back:
    """A search that goes on from what the last of ``steps`` accepted."""
    last = steps[-1].accepted
    assert last is not None
    assert last.trial.refit is not None
    present = {term.name for term in last.trial.refit.model.terms}
    return steps, last.trial.refit, [one for each in steps for one in each.taken if one.name in present]


def said_of(step: Step) -> str:
    """What a step decided, in one line."""
    if step.minor:
        return step.minor
    if step.left_out:
        return f"the time limit left out {counted(len(step.left_out), 'effect')}"
    if step.accepted is None:
        return f"none of {len(step.trials)} effects passes"
    best = step.accepted
    if step.together is not None:
        names = [one.name for one in step.taken]
        (gain,) = (pair.gain for pair in step.pairs if pair.name == " + ".join(names))
        return f"{' and '.join(names)} take {gain:.1%} off the held-out error, only together"
    others = [t.candidate.name for t in best.alike if t is not best.trial]
    alike = f"; it cannot be told from {', '.join(others)}" if others else ""
    return f"{best.name} takes {best.trial.gain:.1%} off the held-out error{alike}"
