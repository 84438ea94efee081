"""In words, what a trace tells beside its verdict: idle effects, refused rivals, what a network finds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from operator import attrgetter

from hybridid.effects.library import EFFECTS
from hybridid.estimators.floor import MISFIT
from hybridid.naming import counted, listed
from hybridid.quantities import estimated, percent, probability, quantity, share
from hybridid.trace.entries import AcceptedEffect, EstimatedValue, TriedEffect, Value
from hybridid.trace.results.completeness import Completeness
from hybridid.trace.results.result import Trace
from hybridid.trace.rules import Rules
from hybridid.trace.trials.constancy import NO_CONSTANT
from hybridid.trace.trials.trial import UNIDENTIFIABLE, UNTRIED
from hybridid.trace.words.refused_words import largest_refused

RIVALS = 3
"""Of the largest gains of a step, among which undetermined rivals are told."""
LOOK_ALIKES: Mapping[str, tuple[str, ...]] = {effect.id: effect.look_alikes for effect in EFFECTS}


def idle_in_words(found: Trace) -> str:
    """Which declared effects the records show nothing of, or do not tell apart; empty if there is none. Where
    all is unexplained, the standard errors are those of a wrong model, and nothing is told."""
    if found.verdict == "unexplained" and found.times > found.rules.far:
        return ""
    was = "were" if len(found.idle) > 1 else "was"
    where = "Beside what is missing" if found.times > found.rules.far else "Over these horizons"
    nothing = f"the records do not tell {listed(found.idle)}, which {was} declared, from zero"
    either = (
        f"each of {listed(found.either)}, which were declared, may be zero, but not all of them: what they "
        "do together is shown, which of them does it is not"
    )
    told = [words for words, names in ((nothing, found.idle), (either, found.either)) if names]
    return f"{where}, {'. And '.join(told)}." if told else ""


def unsure_in_words(found: Trace) -> str:
    """What "± ?" means, where an accepted effect has such a parameter; else empty."""
    every = [value for entry in found.accepted for value in entry.parameters.values()]
    if all(math.isfinite(value.std) for value in every):
        return ""
    return (
        "± ?: no standard error. The value ends at its bound, the records do not determine it, or the "
        "sensitivities of a machine that sticks grow without end."
    )


def others_in_words(found: Trace) -> str:
    """The parameters of the last model beside those of accepted effects, where it is not the declared one;
    else empty."""
    if not (found.accepted or found.narrowed):
        return ""
    own = tuple(f"{entry.name}." for entry in found.accepted)
    others = {name: value for name, value in found.estimates.after.items() if not name.startswith(own)}
    if not others:
        return ""
    wrong = " (the errors ± do not count what is missing)" if found.times > found.rules.far else ""
    which = "other parameters" if found.accepted else "parameters"
    return f"{which} of the last model: {', '.join(parameters_in_words(others))}{wrong}"


def narrowed_in_words(found: Trace) -> str:
    """Which smoothings of sign(v) were made narrower, and what that says of the gains; empty if none was."""
    if not found.narrowed:
        return ""
    told = listed(
        [
            f"{quantity(one.used, one.unit)} instead of {quantity(one.declared, one.unit)} ({one.name})"
            for one in found.narrowed
        ]
    )
    said = f"sign(v) is smoothed over {told}: the wider smoothing left an error of its own."
    if not found.accepted:
        return said
    return f"{said} The gain of an effect in the table is that of its step, which may have had the wider one."


def finer_in_words(found: Trace) -> str:
    """That the integrator's steps were made shorter; empty if they were not."""
    if found.finer == 1:
        return ""
    return (
        f"The integrator takes {found.finer} times as many steps a sample as smooth motion asks for: longer "
        "ones left an error of their own at an edge of the motion."
    )


def rivals(found: Trace) -> tuple[str, ...]:
    """Effects that explain as much as an accepted one, or may, and why they are no names."""
    return (*refused_rivals(found), *richer_laws(found), *undetermined_rivals(found))


def told_apart(entry: AcceptedEffect, rules: Rules) -> str:
    """How far the members of a class are alike: which of them leave more error than the accepted one in the
    last model, by ``Rules.tie`` or more, and how much. Where most of what one leaves is its own misfit, it is
    not alike; but no test has excluded it. Where it is less, no test has shown that it is worse."""
    worse = [one for one in entry.class_members if one.more >= rules.tie]
    if not worse:
        return "these records cannot tell them apart"
    how = "not excluded" if any(1.0 + one.more > MISFIT for one in worse) else "not significantly worse"
    return f"{how}: {listed([f'{one.name} leaves {share(one.more)} more error' for one in worse])}"


def refused_rivals(found: Trace) -> tuple[str, ...]:
    """Effects not shown to explain less than an accepted one that were refused for their amplitudes. Beside a
    pair there are none: what one of its members cannot be told from was tried in its place."""
    return tuple(
        f"{trial.name} is not shown to explain less than {step.accepted}, but {trial.reason}."
        for step in found.steps
        if step.together is None and step.accepted in [one.name for one in found.accepted]
        for trial in step.trials
        if trial.reason.startswith(NO_CONSTANT)
    )


def richer_laws(found: Trace) -> tuple[str, ...]:
    """Effects that contain the law of an accepted one and explain as much, but whose further parameters the
    records do not determine. The simpler law is preferred; the records do not exclude the richer one."""
    return tuple(
        f"{rich.name} contains the law of {poor.effect} and explains as much ({rich.reason}). These "
        "records do not exclude it."
        for entry in found.accepted
        if not entry.together
        for poor in entry.class_members[:1]
        for step in found.steps[entry.step - 1 : entry.step]
        for rich in step.trials
        if rich.status == UNIDENTIFIABLE and rich.port == poor.port and _contains(rich, poor)
        if 1.0 - rich.gain <= (1.0 + found.rules.tie) * (1.0 - poor.gain)
    )


def undetermined_rivals(found: Trace) -> tuple[str, ...]:
    """Effects of another law that explain as much as an accepted one, the best first, but whose parameters
    the records do not determine."""
    return tuple(
        f"{rival.name} explains as much as {entry.name} ({share(rival.gain)}), but {rival.reason}."
        for entry in found.accepted
        if not entry.together
        for best in entry.class_members[:1]
        for step in found.steps[entry.step - 1 : entry.step]
        for rival in sorted(step.trials, key=lambda one: -one.gain)[:RIVALS]
        if rival.status == UNIDENTIFIABLE and rival.name not in {one.name for one in entry.class_members}
        if not (rival.port == best.port and _contains(rival, best))
        if 1.0 - rival.gain <= (1.0 + found.rules.tie) * (1.0 - best.gain)
    )


def _contains(rich: TriedEffect, poor: TriedEffect) -> bool:
    """As ``hybridid.trace.trials.contained.contains``, by their names."""
    alike = rich.effect in LOOK_ALIKES.get(poor.effect, ()) or poor.effect in LOOK_ALIKES.get(rich.effect, ())
    return alike and poor.parameters.keys() < rich.parameters.keys()


def named_effects(found: Trace) -> int:
    """How many effects of the library, and of the user's own, could be fitted; composed laws do not count."""
    fitted = [entry.is_law for entry in found.rejected if entry.status != UNTRIED]
    return [*fitted, *(entry.is_law for entry in found.accepted)].count(False)


def tried_in_words(found: Trace) -> str:
    """``38 effects``, or ``38 effects, 24 of 703 pairs of them and 26 laws``."""
    named = named_effects(found)
    laws = len(found.rejected) + len(found.accepted) - named
    tried = [counted(named, "effect")]
    if pairs := sum(len(step.pairs) for step in found.steps):
        tried.append(f"{pairs} of {sum(step.family for step in found.steps)} pairs of them")
    return listed([*tried, counted(laws, "law")] if laws else tried)


def structure_in_words(found: Trace) -> str:
    """What learned efforts say of the error that is left."""
    worth = percent(found.rules.worth)
    if found.remains:
        return (
            f"Structure remains {listed(found.remains)}: a {learned(found)} there still lowers the held-out "
            f"error by {worth} or more, and no effect in the library does."
        )
    if any(found.rules.passes(c.gain, c.p_value) for c in found.ceilings.after):
        shows = "where something is missing" if found.times > found.rules.far else "that something is missing"
        return (
            f"A {learned(found)} still lowers the held-out error by {worth} or more, but the strongest do "
            "not keep that gain when the equations are solved another way (epsilon, step, integrator): they "
            f"do not show {shows}."
        )
    if not found.ceilings.after:
        return f"No {learned(found)} was tried."
    return f"No {learned(found)} is shown to take {worth} or more from the held-out error."


def mostly_unshown(found: Trace) -> str:
    """That most of what is left far above the noise is a function of none of the variables that learned
    efforts look at; empty where one takes most of it, or not all were tried."""
    solved = [one for one in found.ceilings.after if not one.failure]
    untried = any(not one.fitted for one in solved)
    if not solved or untried or found.times <= found.rules.far:
        return ""
    most = max(solved, key=attrgetter("gain"))
    if most.gain > 0 and 1.0 - (1.0 - most.gain) ** 2 >= found.rules.majority:
        return ""
    takes = (
        f"The strongest {learned(found)} (at {most.port} over {most.over}) takes {share(most.gain)} of it"
        if most.gain > 0
        else f"No {learned(found)} helps"
    )
    loop = " In a closed loop it goes with the motion, and may look like structure." if found.remains else ""
    return (
        f" {takes}: most of what is left is no function of a single variable that trace looks at, and a "
        f"disturbance that no record shows can leave as much.{loop}"
    )


def learned(found: Trace) -> str:
    """``learned effort``, ``learned flow`` or both, by the ports of the plant."""
    kinds = sorted({one.kind for one in found.ceilings.after}) or ["effort"]
    return f"learned {' or '.join(kinds)}"


def completeness_in_words(found: Trace) -> str:
    """What a network still takes from the held-out error, before and after; empty without a network."""
    check = found.completeness
    if check is None:
        return ""
    p = f" (p {probability(check.p_value, '= ')})" if check.gain > 0 else ""
    left, before = (share(gain) if gain > 0 else "nothing" for gain in (check.gain, check.gain_before))
    finds = _what_the_network_finds(found, check)
    if not found.accepted:
        return f"a network ({check.network}) takes {left} from the held-out error{p}. {finds}"
    other = "" if check.network_before == check.network else f"another one ({check.network}) takes "
    return (
        f"a network ({check.network_before}) takes {before} from the held-out error of the "
        f"declared model, and {other}{left} from the held-out error of the last one{p}. {finds}"
    )


def _what_the_network_finds(found: Trace, check: Completeness) -> str:
    if check.gain < found.rules.worth:
        if refused := largest_refused(found):
            return f"That is less than {percent(found.rules.worth)}. But {refused}"
        unsolved = any(one.failure for one in found.ceilings.after)
        unseen = found.times > found.rules.far and not unsolved
        less = f"That is less than {percent(found.rules.worth)}: " if check.gain > 0 else "So "
        more = "; what is missing is no function of these variables alone" if unseen else ""
        return f"{less}it finds nothing more worth having{more}"
    if check.complete:
        level = percent(found.rules.alpha)
        return (
            f"At the level of {level} that is not shown to be more than chance, which does not say that "
            "nothing is missing"
        )
    if not found.remains:
        return "That gain does not survive other ways of solving the equations"
    return "It finds what none of the effects tried is shown to explain"


def parameters_in_words(values: Mapping[str, Value | EstimatedValue]) -> list[str]:
    """``df_v = 73.9 ± 8.9 N·s/m`` of each parameter: its value and half its 95 % interval."""
    return [f"{name} = {estimated(p.value, p.std, p.unit)}" for name, p in values.items()]


def equation_in_words(entry: AcceptedEffect) -> str:
    """``F = k r √(r/h), with h = 0.3 m``: the equation, and the constants in it that are not estimated."""
    constants = [f"{name} = {quantity(one.value, one.unit)}" for name, one in entry.known.items()]
    return f"{entry.equation}, with {listed(constants)}" if constants else entry.equation


def none_of(tried: int, does: str) -> str:
    """``none of the 38 effects tried explains``, with ``does`` the verb."""
    if tried == 0:
        return f"no effect was tried to {does}"
    if tried == 1:
        return f"the one effect tried does not {does}"
    return f"none of the {tried} effects tried {does}s"
