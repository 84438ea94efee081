"""A trace's verdict in words."""

from __future__ import annotations

from hybridid.naming import counted, listed
from hybridid.quantities import multiple, percent, places_below_all, quantity, share
from hybridid.trace.entries import AcceptedEffect, TriedEffect
from hybridid.trace.noise_floor.input_noise import NoisyInputs
from hybridid.trace.results.result import Trace
from hybridid.trace.search.steps import AT_FLOOR_TOGETHER
from hybridid.trace.trials.trial import PASSED, UNTRIED
from hybridid.trace.words.cut_words import best_tried, cut_short, cut_step, passed_in
from hybridid.trace.words.law_words import in_place_of, nearest_law, passed_before, proposed
from hybridid.trace.words.recording_words import by_recording_in_words, comes_first, disagreement_in_words
from hybridid.trace.words.refused_words import more_than_possible, most_refused
from hybridid.trace.words.remarks import (
    mostly_unshown,
    named_effects,
    none_of,
    parameters_in_words,
    told_apart,
)
from hybridid.trace.words.replacement_words import revised_in_words

VERDICTS = {
    "effect_found": "effect found",
    "ambiguous": "ambiguous",
    "law_proposed": "law proposed",
    "nothing_missing": "nothing missing",
    "undecided": "undecided",
    "unexplained": "unexplained",
}
FEW = 3
"""Members of a class up to which each is told with its parameters."""
WORTH_TELLING = 3.0
"""The error of the parameters is told from the sensor's noise over this: it then counts by more than 5 %."""
NEGLIGIBLE = 0.01
"""Times the sensor's noise below which another error is not told."""


def sentence(found: Trace) -> str:
    """The verdict in words: what the time limit and failed fits left out, if anything; then what the model
    lacked and how far the error falls, or what is left. Where no effect was found, or each name is refuted, a
    parameter that differs by recording comes first: one value for all of them leaves what follows. So does
    what may differ between the recordings, where that leaves no more than all that was found."""
    said, differs = _concluded(found) + revised_in_words(found), by_recording_in_words(found)
    first = comes_first(found) or bool(found.disagreement)
    differs = differs or disagreement_in_words(found)
    told = f"{differs.lstrip()} With one value for all recordings: {said}" if first else said + differs
    return cut_short(found) + _untried(found) + told


def _concluded(found: Trace) -> str:
    length = float(f"{found.horizon:.4g}")
    where = f"on held-out horizons of {length:g} s ({found.provenance})"
    if found.verdict == "nothing_missing":
        return f"Nothing that can be found is missing: {_none_passes(found, where)} {error_left(found)}"
    if found.verdict == "undecided" and not found.accepted:
        last = cut_step(found)
        beside = " without it" if last and passed_in(last) else ""
        return f"{_undecided(found, where)} {error_left(found, beside)}"
    if found.verdict == "unexplained":
        place = f": structure remains {listed(found.remains)}, {where}" if found.remains else ""
        withdrawn = f" {found.withdrawn}." if found.withdrawn else ""
        refused, nearest = most_refused(found), nearest_law(found)
        told = f"{place}.{withdrawn}{refused}{nearest} {error_left(found)}{mostly_unshown(found)}"
        return f"Something is missing that {_unnamed(found, unshown=bool(refused))}{told}"
    named = [one for one in found.accepted if one.shown]
    them = "them" if len(named) > 1 else "it"
    fall = f"with {them}{_unshown(found)} the RMSE {where} falls {_fall(found)}"
    if found.verdict == "undecided":
        return _best_so_far(found, fall)
    names = [one for one in named if not one.is_law]
    laws = [one for one in named if one.is_law]
    doubted = found.verdict == "ambiguous" and all(len(one.alike) < 2 for one in found.accepted)
    may_have = "may have lacked" if doubted else "lacked"
    lacked = f"The model {may_have} {listed([_named(entry, found) for entry in names])}"
    if not laws:
        return f"{lacked}: {fall}.{_only_together(found)}{_rest(found)}"
    before, something = (f"{lacked}. ", "Something else") if names else ("", "Something")
    rest = _only_together(found) + _rest(found)
    unsure = passed_before(laws, found)
    why = f".{unsure}" if unsure else f" that {_unnamed(found)}."
    return f"{before}{something} is missing{why} {proposed(laws)}: {fall}.{in_place_of(found)}{rest}"


def _unshown(found: Trace) -> str:
    """What the last model holds beside the names, though the records do not show it; empty if nothing."""
    names = [one.name for one in found.accepted if not one.shown]
    if not names:
        return ""
    many = len(names) > 1
    said = "they are no names: their intervals include" if many else "it is no name: its interval includes"
    return f", and with {listed(names)}, which these records hardly show ({said} zero),"


def _undecided(found: Trace, where: str) -> str:
    """That, and why, it is open whether something is missing."""
    if last := cut_step(found):
        return f"The best so far: {best_tried(last)} {where}."
    return f"These records do not decide whether something is missing: {_why_open(found, where)}."


def _of_inputs(noisy: NoisyInputs) -> str:
    """How much noise the inputs have at most, and the error that it makes."""
    levels, leaves = (
        listed([f"{quantity(one.value, one.unit, 2)} of {name}" for name, one in each.items()])
        for each in (noisy.levels, noisy.leaves)
    )
    return f"The records show white noise of at most {levels}; if a sensor makes it, it alone leaves {leaves}"


def _best_so_far(found: Trace, fall: str) -> str:
    """What a search had accepted that the time limit ended far above the noise."""
    named = [_named(entry, found) for entry in found.accepted if entry.shown]
    names, their = listed(named), "its" if len(named) < 2 else "their"
    return (
        f"The best so far: {names}; {fall}.{_only_together(found)} {error_left(found)} The search for the "
        f"rest was cut off. It may put another effect in {their} place."
    )


def _why_open(found: Trace, where: str) -> str:
    alone = "what noise and simulation alone leave"
    if found.noisy and found.times > found.rules.far:
        return (
            f"{_unexplained(found, where)}, but noise of an input may. {_of_inputs(found.noisy)}. If "
            f"{listed(list(found.noisy.levels))} is known exactly, as a command is, something is missing"
        )
    if found.steady is not None:
        return (
            f"{_unexplained(found, where)}, and over horizons of {found.steady:.2g} s it is as large. "
            "So it may be a noise with a memory, an error of the sensor, or an effect that is faster"
        )
    if found.refused:
        return f"{where} the RMSE would fall by {found.refused}"
    nothing = f"{where} nothing that can be found is, but"
    if found.too_short:
        return (
            f"{nothing} the fitted initial state of so few samples may follow what is missing, and these "
            "records are too short for longer horizons"
        )
    if found.vague:
        return (
            f"{nothing} the fitted records leave the parameters so uncertain that what is missing may hide "
            "behind them"
        )
    if found.longer:
        seconds, times = f"{found.longer.seconds:.2g}", multiple(found.longer.times)
        if not found.longer.judged:
            return (
                f"{nothing} fitted over horizons of {seconds} s the model leaves {times} {alone}. Too few of "
                "these are held out to judge: a longer record may show what is missing"
            )
        more = f"trace.horizon={seconds} may show what is missing"
        if found.noisy:
            more = (
                "Noise of an input adds up over longer horizons, so that alone shows nothing that is missing"
            )
        return f"{nothing} over horizons of {seconds} s the model leaves {times} {alone}. {more}"
    return (
        f"the fitted horizons leave {multiple(found.times_fitted)} {alone}, but "
        f"{_unexplained(found, where)}, which may show too little of the machine"
    )


def _only_together(found: Trace) -> str:
    """Which accepted effects were found as a pair, and whether they help only together; empty if none."""
    names = [one.name for one in found.accepted]
    said = ""
    for one in found.accepted:
        if one.together not in names[names.index(one.name) :]:  # told with the first of the two
            continue
        step = found.steps[one.step - 1]
        passed = any(t.status == PASSED and t.name in (one.name, one.together) for t in step.trials)
        why = (
            "were found together: they explain more than what passed alone"
            if passed
            else "help only together: neither passed alone"
        )
        said += f" {one.name} and {one.together} {why}."
    return said


def _unnamed(found: Trace, unshown: bool = False) -> str:
    """``none of the 38 effects tried explains``, and no pair where pairs were tried; ``unshown``: one of them
    may, but the records do not show it."""
    pairs = sum(len(step.pairs) for step in found.steps if len(step.taken) < 2)
    together = f", alone or in {counted(pairs, 'pair')}" if pairs else ""
    tried = named_effects(found)
    if not unshown:
        return none_of(tried, "explain") + together
    none = "the one effect tried is not" if tried == 1 else f"none of the {tried} effects tried is"
    return f"{none} shown to explain{together}"


def _unexplained(found: Trace, where: str) -> str:
    """``none of the 38 effects tried explains the error on held-out horizons of 1 s``."""
    none = _unnamed(found)
    return f"{none}{',' if ',' in none else ''} the error {where}"


def _none_passes(found: Trace, where: str) -> str:
    """Why nothing was accepted; a gain that was refused is told, or the sentence would hide it."""
    tried, worth = found.rejected, found.rules.worth
    if not tried:
        return f"{found.stopped} {where}{'' if found.steps else ', so no effect was tried'}."
    fails = f"{none_of(len(tried), 'lower')} the error {where} by {percent(worth)}"
    most = max(tried, key=lambda entry: entry.gain)
    if most.gain < worth:
        return f"{fails}."
    survives = "pass" if len(tried) == 1 else "passes"
    return (
        f"{fails} and {survives} every test. The largest gain, {share(most.gain)} with {most.effect} at "
        f"{most.port}, is refused: {most.reason}.{more_than_possible(most.gain, found.times)}"
    )


def error_left(found: Trace, beside: str = "") -> str:
    """How far the error that is left is from what noise and simulation alone leave; ``beside`` says beside
    what, in words."""
    each, leave = [], "noise and simulation alone leave"
    for name, one in found.noise_floor.items():
        rmse = quantity(found.path[-1].held_out_rmse[name], one.unit, 3)
        parts = {"noise of the sensor": one.value, "error of the simulation": one.simulation}
        if one.parameters > one.value / WORTH_TELLING:
            parts["error of the parameters that the noise has moved"] = one.parameters
            leave = "noise, simulation and parameters may leave"
        least = NEGLIGIBLE * one.value
        told = ", ".join(f"{what} {quantity(v, one.unit, 2)}" for what, v in parts.items() if v >= least)
        each.append(f"{rmse} of {name} ({told})")
    noisy = f" {_of_inputs(found.noisy)}." if found.noisy and found.times <= found.rules.far else ""
    return f"The error left{beside} is {listed(each)}: {multiple(found.times)} what {leave}.{noisy}"


def _untried(found: Trace) -> str:
    """Which effects and learned efforts could not be fitted: the verdict does not speak of these."""
    names = [entry.name for entry in found.rejected if entry.status == UNTRIED and not entry.is_law]
    names += [f"a learned {c.kind} at {c.port} over {c.over}" for c in found.ceilings.after if c.failure]
    them = "them" if len(names) > 1 else "it"
    return f"The verdict leaves out {listed(names)}: no fit could solve {them}. " if names else ""


def _named(entry: AcceptedEffect, found: Trace) -> str:
    """An accepted effect with its parameters, or the class that it stands for."""
    if len(entry.class_members) > 1:
        return f"one of {_members(entry)} ({told_apart(entry, found.rules)})"
    return f"{entry.effect} at {entry.port} ({', '.join(parameters_in_words(entry.parameters))})"


def _members(entry: AcceptedEffect) -> str:
    """``{dahl, coulomb} at motor``, or each with its port where these differ; a few with their parameters."""
    there = {member.port for member in entry.class_members} <= {entry.port}
    each = dict.fromkeys(_member(member, entry, there) for member in entry.class_members)
    return f"{{{', '.join(each)}}}" + (f" at {entry.port}" if there else "")


def _member(member: TriedEffect, entry: AcceptedEffect, there: bool) -> str:
    """A member of the class of ``entry``, with its parameters in the last model where these are few."""
    text = member.effect if there else f"{member.effect} at {member.port}"
    if len(entry.class_members) > FEW:
        return text
    values = entry.parameters if member.name == entry.name else member.parameters
    return f"{text} ({', '.join(parameters_in_words(values))})" if values else text


def _fall(found: Trace) -> str:
    """From where to where, for each output, the one that falls most first."""
    first, last = found.path[0].held_out_rmse, found.path[-1].held_out_rmse
    falls = []
    for name, before in sorted(first.items(), key=lambda one: last[one[0]] / one[1]):
        unit, after = found.noise_floor[name].unit, last[name]
        change = f"{_whole(abs(1 - after / before))} {'less' if after <= before else 'more'}"
        falls.append(f"from {quantity(before, unit, 3)} to {quantity(after, unit, 3)} ({change}) in {name}")
    return listed(falls)


def _whole(change: float) -> str:
    """``96 %``; ``99.5 %`` where no less than nearly all is meant."""
    return percent(change, 0 if change < 0.99 else places_below_all(change, 1))


def _rest(found: Trace) -> str:
    return _structure(found) + _more_is_missing(found)


def _structure(found: Trace) -> str:
    """Where a learned effort still finds something. The noise of a logged input passes through the machine,
    and is no part of the sensors' noise: near that, it may be what was found."""
    if not found.remains:
        return ""
    if found.times > found.rules.far:
        return f" Structure remains {listed(found.remains)} that no effect in the library explains."
    return (
        f" Structure may remain {listed(found.remains)}. But only {multiple(found.times)} the error of noise "
        "and simulation is left, and the noise of a logged input alone can do that."
    )


def _more_is_missing(found: Trace) -> str:
    """That names are less sure where far more than noise and simulation is left; empty where it is not."""
    if found.times <= found.rules.far < found.times_fitted:
        left = f"leave {multiple(found.times_fitted)} what noise and simulation alone leave"
        return f" More may be missing: the fitted horizons {left}."
    if found.times <= found.rules.far:
        return ""
    if found.stopped == AT_FLOOR_TOGETHER:
        return (
            f" The error left is {multiple(found.times)} what noise and simulation alone leave. Fitted to "
            "all horizons together, the model leaves no more than that: its parameters are uncertain."
        )
    if found.noisy:
        return (
            f" The error left is {multiple(found.times)} what noise and simulation alone leave, but no more "
            f"need be missing. {_of_inputs(found.noisy)}."
        )
    left = f"the error left is {multiple(found.times)} what noise and simulation alone leave"
    most = max((one.gain for one in found.ceilings.after), default=float("inf"))
    if most < found.rules.worth:
        return (
            f" More may be missing: {left}. But no learned effort takes {percent(found.rules.worth)} of it, "
            "and a disturbance that no record shows can leave as much. A name may stand for a part of that."
        )
    return f" More is missing: {left}. A name may stand for a part of that."
