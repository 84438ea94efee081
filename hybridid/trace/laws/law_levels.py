"""Laws of two variables: the amplitude of a law of one variable, as a shape over another variable.

    F = k f(x) factor g(y)

Where y does not follow x, the best law over x alone has the shape f, and its amplitude is the mean of the
level g. So first laws of one variable are fitted (``hybridid.trace.laws.laws``). Where the best one does not
reach the noise, the amplitudes of the best law over each variable are freed over every other variable
(``hybridid.trace.learned.varying``). If one that was freed explains more than the best law, every level of
``hybridid.effects.levels`` over its variable is fitted with the law, beside the same model as the laws of one
variable. The same rules then judge all of them together, and the p-values count every law with every level
over every variable, tried or not. So a level is proposed only where no law of one variable does as well.

A product of which no factor shows alone is not found: its mean over each variable is zero.

Source: Hastie, Tibshirani (1993), Varying-coefficient models, J. Royal Statistical Society B 55(4), 757-796.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hybridid.effects.composed import ComposedLaw, composed, levels_beside
from hybridid.effects.levels import Level, levels_over, overs_of_level
from hybridid.effects.over import Over
from hybridid.effects.shapes import shapes_over
from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.laws.level_starts import level_starts
from hybridid.trace.learned.ceiling import Ceiling
from hybridid.trace.learned.varying import Varied, vary
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refit import least_of
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.trials.judgement import judge
from hybridid.trace.trials.trial import PASSED, Trial, attempt

FIRST = 3
"""Laws of one variable, the best of each variable, whose amplitudes are freed."""


@dataclass(frozen=True)
class WithLevel:
    """A law times a level: its ``trial``, and the amplitude ``freed`` over the level's variable in the
    ``law`` of one variable."""

    trial: Trial
    law: Trial
    freed: Varied


def with_levels(
    base: Refit, laws: Sequence[Trial], learned: Sequence[Ceiling], context: Context
) -> tuple[list[WithLevel], int]:
    """The ``laws`` beside ``base`` times levels, where a freed amplitude explains more than the best of them;
    and the number of all products that could be formed over the variables of ``learned``."""
    rules, found = context.rules, list[WithLevel]()
    for law, one, refitted in _worth_a_level(laws, context):
        most = max((w.trial.taken for w in found), default=0.0)
        if base.score.loss**2 - refitted.score.loss**2 < (1 - rules.stands_in) * most:
            continue
        given = [
            (law.candidate, Level(one.over, shape.name), one, base, context.split, rules.worth)
            for shape in levels_over(one.over)
        ]
        trials = context.each(f"{law.candidate.name} by {one.over}", try_level, given, _name)
        found += [WithLevel(trial, law, one) for trial in trials]
    return found, products_over(learned, context) if found else 0


def _worth_a_level(laws: Sequence[Trial], context: Context) -> list[tuple[Trial, Varied, Refit]]:
    """The laws whose freed amplitude explains more than the best law, which does not reach the noise; the
    amplitude that leaves least first."""
    rules = context.rules
    passed = [t for t in judge(laws, rules, len(laws)) if t.status == PASSED]
    best = max(passed, key=lambda t: t.gain, default=None)
    if best is None or best.refit is None or context.meets_noise(best.refit.score):
        return []
    freed = [
        (law, one, one.refit)
        for law, one in _freed(_best_of_each_variable(passed), context)
        if one.refit is not None and _explains_more(best.refit, one.refit, rules)
    ]
    return sorted(freed, key=lambda each: each[2].score.loss)


def try_level(
    law: Candidate, level: Level, freed: Varied, base: Refit, split: Split, worth: float = Rules.worth
) -> Trial:
    """Refit ``base`` with ``law`` times ``level``, in the likeness of the law's ``freed`` amplitude."""
    of = law.effect.law
    assert isinstance(of, ComposedLaw)
    starts = level_starts(law, level, freed, split)
    effect = composed(of.over, of.shape, law.effect.kind, starts, level)
    return attempt(Candidate(effect, law.port), base, split, worth)


def _name(trial: Trial) -> str:
    return trial.candidate.name


def _explains_more(best: Refit, freed: Refit, rules: Rules) -> bool:
    better = compare(best.score, freed.score)
    return rules.passes(better.gain, better.p_value)


def _best_of_each_variable(passed: Sequence[Trial]) -> list[Trial]:
    """The best law over each variable at each port, the best ones first."""
    best: dict[tuple[str, Over], Trial] = {}
    for trial in sorted(passed, key=lambda t: -t.gain):
        best.setdefault((trial.candidate.port, _law(trial).over), trial)
    return list(best.values())[:FIRST]


def _freed(laws: Sequence[Trial], context: Context) -> list[tuple[Trial, Varied]]:
    """The amplitude of each law, freed over each other variable that its port shows."""
    places = [(law, over) for law in laws for over in _others(law, context)]
    given = [
        (law.refit, context.split, law.candidate.name, over, least_of(context.rules.worth))
        for law, over in places
    ]
    tried = context.each("amplitudes of laws", vary, given, lambda one: f"{one.name} over {one.over}")
    return [(law, one) for (law, _), one in zip(places, tried, strict=True)]


def _others(law: Trial, context: Context) -> list[Over]:
    found, port = law.refit, law.candidate.port
    assert found is not None
    path = Path.of(found, context.split, context.split.fitted)
    every = overs_of_level(_law(law).over, law.candidate.effect.kind, found.model.signals)
    wanted = context.variables
    return [o for o in every if (wanted is None or o.variable in wanted) and path.shows(port, o)]


def _law(trial: Trial) -> ComposedLaw:
    law = trial.candidate.effect.law
    assert isinstance(law, ComposedLaw)
    return law


def products_over(learned: Sequence[Ceiling], context: Context) -> int:
    """The number of laws over the variables of ``learned``, each with every level that it may have."""
    signals = learned[0].refit.model.signals
    wanted = context.variables
    return sum(
        len(shapes_over(one.over.variable))
        for one in learned
        for level in levels_beside(one.over, one.kind, signals)
        if wanted is None or level.over.variable in wanted
    )
