"""A trace's verdict in words."""

from __future__ import annotations

from hybridid.naming import listed
from hybridid.quantities import estimated, percent, probability, quantity, share
from hybridid.trace.completeness import Completeness
from hybridid.trace.entries import AcceptedEffect
from hybridid.trace.result import Trace
from hybridid.trace.trial import UNTRIED

VERDICTS = {
    "effect_found": "effect found",
    "ambiguous": "ambiguous",
    "nothing_missing": "nothing missing",
    "undecided": "undecided",
    "unexplained": "unexplained",
}


def sentence(found: Trace) -> str:
    """The verdict in words: what could not be fitted, if anything; then what the model lacked and how far the
    error falls, or what is left."""
    return _untried(found) + _concluded(found)


def _concluded(found: Trace) -> str:
    where = f"on held-out horizons of {found.horizon:g} s ({found.provenance})"
    if found.verdict == "nothing_missing":
        return f"Nothing that can be found is missing: {_none_passes(found, where)} {error_left(found)}"
    if found.verdict == "undecided":
        return (
            f"These records do not decide whether something is missing: {where} the RMSE would fall by "
            f"{found.refused}. {error_left(found)}"
        )
    if found.verdict == "unexplained":
        place = f"structure remains {listed(found.remains)}, {where}. " if found.remains else ""
        return (
            f"Something is missing that none of the {len(found.rejected)} effects tried explains: "
            f"{place}{error_left(found)}"
        )
    them = "them" if len(found.accepted) > 1 else "it"
    lacked = listed([_named(entry) for entry in found.accepted])
    fall = f"with {them} the RMSE {where} falls {_fall(found)}"
    return f"The model lacked {lacked}: {fall}.{_rest(found)}"


def structure_in_words(found: Trace) -> str:
    """What learned efforts say of the error that is left."""
    worth = percent(found.rules.worth)
    if found.remains:
        return (
            f"Structure remains {listed(found.remains)}: a {learned(found)} there still lowers the held-out "
            f"error by {worth} or more, and no effect in the library does."
        )
    if any(found.rules.passes(c.gain, c.p_value) for c in found.ceilings.after):
        return (
            f"A {learned(found)} still lowers the held-out error by {worth} or more, but the strongest do "
            "not keep that gain when the equations are solved another way (epsilon, step, integrator): no "
            "evidence that the machine lacks something."
        )
    return f"No {learned(found)} takes {worth} or more from the held-out error."


def learned(found: Trace) -> str:
    """``learned effort``, ``learned flow`` or both, by the ports of the plant."""
    kinds = sorted({one.kind for one in found.ceilings.after}) or ["effort"]
    return f"learned {' or '.join(kinds)}"


def completeness_in_words(found: Trace) -> str:
    """What a network still takes from the held-out error, before and after; empty without a network."""
    check = found.completeness
    if check is None:
        return ""
    left, before = (share(max(gain, 0.0)) for gain in (check.gain, check.gain_before))
    p = probability(check.p_value, "= ")
    return (
        f"a network ({check.network}) takes {left} from the held-out error of the last model (p {p}), and "
        f"{before} from that of the declared one. {_what_the_network_finds(found, check)}"
    )


def _what_the_network_finds(found: Trace, check: Completeness) -> str:
    if check.gain < found.rules.worth:
        return f"That is less than {percent(found.rules.worth)}: it finds nothing more that is worth having"
    if check.complete:
        return "That is not significant: it finds nothing more"
    if not found.remains:
        return "That gain does not survive other ways of solving the equations"
    return "It finds what no effect in the library names"


def _none_passes(found: Trace, where: str) -> str:
    """Why nothing was accepted; a gain that was refused is told, or the sentence would hide it."""
    tried, worth = found.rejected, found.rules.worth
    if not tried:
        return f"{found.stopped} {where}."
    fails = f"none of the {len(tried)} effects tried lowers the error {where} by {percent(worth)}"
    most = max(tried, key=lambda entry: entry.gain)
    if most.gain < worth:
        return f"{fails}."
    return (
        f"{fails} and passes every test. The largest gain, {share(most.gain)} with {most.effect} at "
        f"{most.port}, is refused: {most.reason}."
    )


def error_left(found: Trace) -> str:
    """How far the error that is left is from what noise and simulation alone leave."""
    each = []
    for name, one in found.noise_floor.items():
        rmse = quantity(found.path[-1].held_out_rmse[name], one.unit, 3)
        noise, error = (quantity(value, one.unit, 2) for value in (one.value, one.simulation))
        each.append(f"{rmse} of {name} (noise of the sensor {noise}, error of the simulation {error})")
    return f"The error left is {listed(each)}: {found.times:.1f} times what noise and simulation alone leave."


def _untried(found: Trace) -> str:
    """Which effects and learned efforts could not be fitted: the verdict does not speak of these."""
    names = [entry.name for entry in found.rejected if entry.status == UNTRIED]
    names += [f"a learned {c.kind} at {c.port} over {c.over}" for c in found.ceilings.after if c.failure]
    them = "them" if len(names) > 1 else "it"
    return f"The verdict leaves out {listed(names)}: no fit could solve {them}. " if names else ""


def _named(entry: AcceptedEffect) -> str:
    """An accepted effect with its parameters, or the class that it stands for."""
    if len(entry.alike) > 1:
        return f"one of {_members(entry)}, which these records cannot tell apart"
    return f"{entry.effect} at {entry.port} ({', '.join(parameters_in_words(entry))})"


def _members(entry: AcceptedEffect) -> str:
    """``{dahl, coulomb} at motor``, or each with its port where these differ."""
    if {member.port for member in entry.class_members} <= {entry.port}:
        return f"{{{', '.join(entry.alike)}}} at {entry.port}"
    each = dict.fromkeys(f"{member.effect} at {member.port}" for member in entry.class_members)
    return f"{{{', '.join(each)}}}"


def parameters_in_words(entry: AcceptedEffect) -> list[str]:
    """``df_v = 73.9 ± 8.9 N·s/m`` of each parameter: its value and half its 95 % interval."""
    return [f"{name} = {estimated(p.value, p.std, p.unit)}" for name, p in entry.parameters.items()]


def _fall(found: Trace) -> str:
    """From where to where, for each output."""
    first, last = found.path[0].held_out_rmse, found.path[-1].held_out_rmse
    falls = []
    for name, before in first.items():
        unit, after = found.noise_floor[name].unit, last[name]
        change = f"{100 * abs(1 - after / before):.0f} % {'less' if after <= before else 'more'}"
        falls.append(f"from {quantity(before, unit, 3)} to {quantity(after, unit, 3)} ({change}) in {name}")
    return listed(falls)


def _rest(found: Trace) -> str:
    if not found.remains:
        return f" {error_left(found)}" if found.times > found.rules.far else ""
    return f" Structure remains {listed(found.remains)} that no effect in the library explains."
