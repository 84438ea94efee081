"""Effects that may be the wrong law: functions of the variable over which structure remains.

Of an accepted effect that is told: a library holds a few laws over a variable, and names the nearest. A
declared one may have to be replaced. Where nothing that was tried explains the errors, and a learned effort
over a variable does, a declared effect that is itself a function of that variable may be wrong: a search that
only adds cannot replace it. So may any declared effect where no learned effort helps either.
"""

from __future__ import annotations

from collections.abc import Sequence, Set

import numpy as np

from hybridid.effects.composed import ComposedLaw, form_over, is_composed
from hybridid.effects.over import MEMORIES, Over
from hybridid.model import Model
from hybridid.naming import listed
from hybridid.trace.context import Context
from hybridid.trace.doubts.hystereses import one_impedance, several_hystereses
from hybridid.trace.horizons.split import Split
from hybridid.trace.learned.ceiling import Ceiling
from hybridid.trace.learned.law_curve import binned, is_curve_over
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.search.steps import Accepted
from hybridid.trace.starts.shorter import seeks
from hybridid.trace.verdict import Conclusion

CONSTANT = 0.1
"""Share of its mean square below which the variance of an effort is that of a constant: no function of a
variable."""
LITTLE = 0.1
"""Share of a law's mean square from which on its odd or even part is a part of a curve."""
REVISE = "trace.revise=true"
"""Word of a command with which others are sought in the place of each declared effect."""


def doubted(declared: Model, final: Refit, places: Sequence[Ceiling], split: Split) -> list[str]:
    """Names of the ``declared`` effects, still in the model of ``final``, that are functions of the variable
    of a learned effort of ``places`` at their port."""
    path = Path.of(final, split, split.fitted)

    def varies(name: str, port: str) -> bool:
        effort = path.effort_of(name, port)
        return bool(np.var(effort) > CONSTANT * np.mean(effort**2))

    return [
        term.name
        for term in declared.terms
        if term in final.model.terms
        and any(
            one.port == term.port
            and varies(term.name, one.port)
            and is_curve_over(final, term.name, one.port, one.over, split)
            for one in places
        )
    ]


def of_another_law(found: Conclusion, places: Sequence[Ceiling], context: Context) -> list[str]:
    """The accepted effects that are functions of the variable of a learned effort of ``places``: a library
    holds a few laws over it, and names the nearest."""
    names = [one.name for one in found.accepted if not is_composed(one.trial.candidate.effect)]
    final = found.search.final
    return [name for name in doubted(final.model, final, places, context.split) if name in names]


def refuted_form(found: Conclusion, context: Context) -> list[str]:
    """The accepted effects whose form the records refute, though not their variable: a learned effort over it
    takes most of the squared error that is left far above the noise (``Rules.majority``, ``Rules.far``).

    It is a test of lack of fit: of all functions of the variable the effect is one. Source: Draper, Smith
    (1998), Applied Regression Analysis, 3rd ed., sec. 2.1.
    """
    rules = context.rules
    if found.times <= rules.far:
        return []
    left = found.search.final.score.loss**2
    most = [one for one in _remaining(found) if left - one.refit.score.loss**2 >= rules.majority * left]
    return of_another_law(found, most, context)


def in_doubt(found: Conclusion, instead: Set[str], context: Context) -> bool:
    """Whether a name is in doubt: it is one of those ``instead`` of which something else explains as much,
    the records refute its form, or it stands for a part of a sum (``one_curve``, and
    ``hybridid.trace.doubts.hystereses``). Proposed laws are in doubt if something else explains as much as
    each, or if a name beside one is a part of its curve."""
    if found.verdict == "law_proposed":
        laws = {one.name for one in found.accepted if is_composed(one.trial.candidate.effect)}
        return laws <= instead or bool(one_curve(found, context))
    a_sum = several_hystereses(found.accepted) or one_impedance(found.accepted) or one_curve(found, context)
    return found.verdict == "effect_found" and bool(instead or a_sum or refuted_form(found, context))


def other_law_possible(found: Conclusion, context: Context) -> str:
    """Which accepted effects are functions of a variable over which structure remains, in words; empty if
    none is, or where the search was cut off."""
    if found.verdict == "undecided":
        return ""
    told = of_another_law(found, _remaining(found), context)
    if not told:
        return ""
    them, its = ("are functions", "their laws") if len(told) > 1 else ("is itself a function", "its law")
    if refuted := refuted_form(found, context):
        is_one = "is a function" if len(refuted) == 1 else "are functions"
        return (
            f" {listed(refuted)} {is_one} of a variable over which a learned effort takes most of what is "
            "left: another law over it is there, alone or beside the one that is named."
        )
    return f" {listed(told)} {them} of a variable over which structure remains: {its} may be the wrong one."


def simpler_possible(found: Conclusion, context: Context) -> str:
    """Which accepted effects of several parameters bend over the variable of a declared one at their port, in
    words; empty if none does, or the declared ones were questioned. A search that only adds mends a wrong law
    of a variable with flexible ones: a viscous friction that is declared for Coulomb friction and a drag."""
    if context.revise:
        return ""
    places: dict[tuple[str, Over | None], list[str]] = {}
    for term in found.search.first.model.terms:
        places.setdefault((term.port, form_over(term.effect)), []).append(term.name)
    beside: dict[str, list[str]] = {}
    for one in found.accepted:
        place = one.trial.candidate.port, form_over(one.trial.candidate.effect)
        if one.trial.free_parameters > 1 and place[1] is not None and place in places:
            beside[one.name] = places[place]
    if not beside:
        return ""
    declared = listed(list(dict.fromkeys(name for names in beside.values() for name in names)))
    return (
        f" {listed(list(beside))} and the declared {declared} are functions of one variable: whether others "
        f"with fewer parameters explain as much in their place, {REVISE} asks."
    )


def one_curve(found: Conclusion, context: Context) -> str:
    """That accepted effects are the parts of one curve, in words; empty where none are.

    Effects at one port that are functions of one variable, all odd or all even, add up to one such function,
    and that is what the records show. If one of them bends (a parameter beside its amplitude says where), the
    sum has the freedom of a series, and meets many a law that no library holds. So has a name with a composed
    law over its variable, whose shape was chosen among many.
    """
    places: dict[tuple[str, Over | None], list[Accepted]] = {}
    for one in found.accepted:
        if not seeks(one.trial.candidate):
            places.setdefault((one.trial.candidate.port, _over(one)), []).append(one)
    for (port, over), them in places.items():
        if over is None or over.variable in MEMORIES or len(them) < 2:
            continue
        path = Path.of(found.search.final, context.split, context.split.fitted)
        shares = [_odd_share(path, one.name, port, over) for one in them]
        for shared in (shares, [1.0 - share for share in shares]):
            parts = [one for one, share in zip(them, shared, strict=True) if share > _least(one)]
            bends = any(_is_law(one) or one.trial.free_parameters > 1 for one in parts)
            if len(parts) > 1 and bends and not all(map(_is_law, parts)):
                return (
                    f" Beware: {listed([one.name for one in parts])} are functions of one variable. The "
                    "records show their sum; another law of that variable may have the same curve."
                )
    return ""


def _is_law(one: Accepted) -> bool:
    return is_composed(one.trial.candidate.effect)


def _over(one: Accepted) -> Over | None:
    """The variable and the factor of an accepted effect; None if it has no single one."""
    law = one.trial.candidate.effect.law
    if not isinstance(law, ComposedLaw):
        return form_over(one.trial.candidate.effect)
    return law.over if law.level is None else None


def _least(one: Accepted) -> float:
    """Of its odd or even part, the share that counts: most of a name; little of a law, which may be both."""
    return LITTLE if _is_law(one) else 0.5


def _odd_share(path: Path, name: str, port: str, over: Over) -> float:
    """How much of the effort of the term ``name`` is an odd function of its variable; the rest is even."""
    seen = path.seen(port, over)
    curve = binned(seen, path.effort_of(name, port), path.factor(port, over))
    here, there = curve.over(seen), curve.over(-seen)
    odd, even = float(np.sum((here - there) ** 2)), float(np.sum((here + there) ** 2))
    return odd / (odd + even) if odd + even > 0 else 0.0


def _remaining(found: Conclusion) -> list[Ceiling]:
    return [one for one in found.ceilings if f"at {one.place}" in found.remains]


def revision_advised(found: Conclusion, context: Context) -> str:
    """That ``trace.revise`` may help, in words, where a declared effect may be the wrong law; that the time
    limit left it out, or that it replaces nothing; else empty."""
    if found.unrevised:
        return " The time limit left out trace.revise: no declared effect was questioned."
    questioned = [term.name for term in found.search.first.model.terms] if context.revise else []
    if questioned and not found.replacements:
        return (
            f" trace.revise left out the declared {listed(questioned)} in turn: no other effects in the "
            "place of one explain more, or as much with fewer parameters."
        )
    if found.verdict != "unexplained" or context.revise:
        return ""
    declared = [term.name for term in found.search.final.model.terms]
    if declared and not (found.remains or found.accepted):
        was = "were" if len(declared) > 1 else "was"
        return (
            f" The declared {listed(declared)} {was} not questioned: {REVISE} seeks others in the "
            "place of each."
        )
    names = doubted(found.search.first.model, found.search.final, _remaining(found), context.split)
    if not names:
        return ""
    return (
        f" What is declared over that variable ({listed(names)}) may be the wrong law: {REVISE} "
        "seeks others in its place."
    )
