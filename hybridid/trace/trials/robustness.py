"""Whether a gain survives other ways to solve the equations.

Half a sample of delay, a coarse step or a wide smoothing of sign(v) can look like an
effect. A gain that vanishes when they change is an artefact of the numerics.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from hybridid.model import Model
from hybridid.records.record import HOLDS, Record
from hybridid.simulation.stability import TooStiff
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.numerics import DECLARED, Numerics
from hybridid.trace.refits.refit import FAILURES, WITHOUT_STD, refit, refit_if_possible
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.trials.trial import Trial

Otherwise = dict[Numerics, Refit | None]
"""A model's refits under other numerics."""
OTHER_INTEGRATOR = {"rk4": "rodas3", "rodas3": "rk4"}


@dataclass(frozen=True)
class Survival:
    """What becomes of an effect under one variation of the numerics.

    ``gain`` and ``p_value`` are held out, as declared; ``kept`` is the share that is left of what the effect
    took from the squared error; ``parameters`` are its own. ``refuted``: the variation itself disagrees with
    the records, so it does not count. ``simulated`` is False where the models cannot be simulated so.
    ``survives``: the effect passes, or the variation does not count.
    """

    variation: str
    gain: float
    kept: float
    p_value: float
    parameters: Mapping[str, float]
    refuted: bool
    survives: bool
    simulated: bool = True


def variations(
    records: Sequence[Record], declared: Numerics = DECLARED, smooths: bool = True
) -> tuple[Numerics, ...]:
    """Changes of smoothing, step and integrator that should not change the gain of an effect.

    ``smooths``: the model has an epsilon to change (``Model.smooths``). A hold that a record declares is a
    fact about the recording, and stays. One that is assumed is varied.
    """
    assumed = [c.hold for record in records for c in record.input_channels if c.assumed]
    holds = [hold for hold in HOLDS if assumed and hold != assumed[0]]
    integrator = OTHER_INTEGRATOR[declared.integrator]
    wider, narrower = (
        replace(declared, name="epsilon x 3", smoothing=3.0),
        replace(declared, name="epsilon / 2", smoothing=0.5),
    )
    return (
        *((wider, narrower) if smooths else ()),
        replace(declared, name="half the step", finer=2 * declared.finer),
        replace(declared, name=f"integrator {integrator}", integrator=integrator),
        *(replace(declared, name=f"inputs {hold}", hold=hold) for hold in holds),
    )


def refitted_under(
    base: Refit, varied: Sequence[Numerics], context: Context, stage: str = "by other numerics"
) -> list[Refit | None]:
    """``base`` refitted under each variation; None where it cannot be simulated so. ``stage`` is reported."""
    given = [(base.model, context.split, [base.values], base, numerics) for numerics in varied]
    return context.each(stage, refit_if_possible, given)


def survival(
    base: Refit,
    augmented: Refit,
    term: str,
    split: Split,
    numerics: Numerics,
    rules: Rules,
    poorer: Refit | None,
) -> Survival:
    """Refit ``augmented`` under ``numerics`` and compare again with ``poorer``, the base so refitted.

    The effect must still take ``rules.kept`` of what it took from the squared error as declared. It need not
    be significant a second time: that depends on the number of horizons, not on the numerics. A variation
    does not count if the records refute it: even with the effect the error is ``rules.refuted`` times as
    large. (A coarse smoothing adds an error beside which a true effect looks small.) Records cannot refute a
    finer step: it comes nearer to the equations, so a gain that is lost there was never theirs.

    The effect's amplitudes must not move by more than ``rules.steady`` of their values, or by two standard
    errors: an amplitude that follows the smoothing or the step belongs to these, not to the machine. The hold
    of the inputs is excepted, for a true delay, lag or mass takes up half a sample of delay. So is the
    stiffness of a limit, of which the records may only tell that it is large.

    A variation that needs too many steps a sample does not count. An effect does not survive if the model
    diverges with it.
    """
    if poorer is None:
        return _not_simulated(numerics, survives=True)
    try:
        richer = refit(augmented.model, split, [augmented.values], augmented, numerics, std_up_to=WITHOUT_STD)
    except TooStiff:
        return _not_simulated(numerics, survives=True)
    except FAILURES:
        return _not_simulated(numerics, survives=False)
    again = compare(poorer.score, richer.score)
    own = {name: value for name, value in richer.values.items() if name.startswith(f"{term}.")}
    steady = numerics.hold is not None or all(
        abs(own[name] - augmented.values[name]) <= _room(augmented, name, rules)
        for name in _amplitudes(augmented.model, term)
    )
    taken, then = (a.score.loss**2 - b.score.loss**2 for a, b in ((base, augmented), (poorer, richer)))
    kept = float(then / taken) if taken > 0 else 0.0
    worse = richer.score.loss > rules.refuted * augmented.score.loss
    refuted = bool(worse and numerics.finer <= augmented.numerics.finer)
    passes = kept >= rules.kept and steady
    return Survival(numerics.name, again.gain, kept, again.p_value, own, refuted, refuted or passes)


def survivals_of(base: Refit, best: Trial, context: Context, otherwise: Otherwise) -> tuple[Survival, ...]:
    """What becomes of the gain of ``best`` under every variation of the numerics it was solved with.

    ``otherwise`` holds the base under the variations of earlier calls, and takes those of this one.
    """
    assert best.refit is not None
    split, name = context.split, best.candidate.name
    varied = variations(split.records, best.refit.numerics, best.refit.model.smooths)
    new = [numerics for numerics in varied if numerics not in otherwise]
    otherwise.update(zip(new, refitted_under(base, new, context), strict=True))
    given = [(base, best.refit, name, split, how, context.rules, otherwise[how]) for how in varied]
    return tuple(context.each("by other numerics", survival, given))


def _not_simulated(numerics: Numerics, survives: bool) -> Survival:
    return Survival(numerics.name, 0.0, 0.0, 1.0, {}, refuted=False, survives=survives, simulated=False)


def objection(survivals: Sequence[Survival]) -> str:
    """Why these variations speak against an effect; empty if they do not."""
    failed = [one for one in survivals if not one.survives]
    if lost := [_lost(one) for one in failed if not (one.simulated and one.kept >= Rules.kept)]:
        return f"the gain does not survive {', '.join(lost)}"
    if failed:
        return f"the gain stays, but an amplitude moves with {', '.join(map(_lost, failed))}"
    tried = sum(one.simulated for one in survivals)
    if 2 * tried < len(survivals):
        return f"too stiff to be solved in more than {tried} of {len(survivals)} other ways"
    return ""


def surviving(learned: Sequence[Refit], final: Refit, context: Context) -> list[int]:
    """Which of ``learned``, by number, keep their gain over ``final`` under other numerics.

    Each is the model of ``final`` with a learned effort beside it; the test is the one an effect must pass.
    """
    if not learned:
        return []
    smooths = any(one.model.smooths for one in learned)
    varied = variations(context.split.records, final.numerics, smooths)
    poorer = refitted_under(final, varied, context)
    places = [(k, *under) for k in range(len(learned)) for under in zip(varied, poorer, strict=True)]
    given = [(final, learned[k], "", context.split, how, context.rules, base) for k, how, base in places]
    again = context.each("by other numerics", survival, given)
    lost = {k for (k, *_), one in zip(places, again, strict=True) if not one.survives}
    return [k for k in range(len(learned)) if k not in lost]


def _lost(survival: Survival) -> str:
    """A gain under a variation, in words."""
    if not survival.simulated:
        return f"{survival.variation} (it diverges)"
    what = ", ".join(f"{name.rsplit('.', 1)[-1]} {value:.3g}" for name, value in survival.parameters.items())
    return f"{survival.variation} (keeps {max(survival.kept, 0.0):.0%}, p = {survival.p_value:.1g}, {what})"


def _amplitudes(model: Model, term: str) -> list[str]:
    """Qualified names of the parameters that remove the effect when they are zero, and that records tell."""
    return [
        f"{term}.{p.name}"
        for one in model.terms
        if one.name == term
        for p in one.effect.parameters
        if p.nests and not p.hard
    ]


def _room(augmented: Refit, name: str, rules: Rules) -> float:
    """How far a parameter may move."""
    return max(rules.steady * abs(augmented.values[name]), 2 * augmented.std.get(name, 0.0))
