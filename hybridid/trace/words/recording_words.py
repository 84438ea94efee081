"""What differs by recording, in words."""

from __future__ import annotations

import math

from hybridid.naming import listed
from hybridid.quantities import estimated, multiple, probability, share
from hybridid.trace.entries import DifferingParameter
from hybridid.trace.recordings.gauges import is_error_of_gauge, put_right
from hybridid.trace.results.result import Trace
from hybridid.trace.search.steps import RECORDINGS_DIFFER
from hybridid.trace.trials.trial import PASSED


def by_recording_in_words(found: Trace) -> str:
    """Which parameters differ by recording; that none does, where it was asked; else empty."""
    if not found.by_recording:
        return ""
    passed = [one for one in found.by_recording if one.status == PASSED]
    said = "".join(_differs(one) + _bent(one, found) for one in passed if not one.in_place_of)
    for effect, instead in _in_place(found).items():
        if _more(instead[0], found):
            values, how = _values_of(instead[0]), _how_to_go_on(instead[0])
            said += _refutes(instead[0], "" if values in said else f", {values},")
            said += "" if how in said else f" {how}"
            continue
        names = [one.parameter for one in instead]
        said += f" These records cannot tell {effect} from {' or '.join(names)} that differs by recording."
    return said or " No parameter differs by recording."


def disagreement_in_words(found: Trace) -> str:
    """What values of its own for each recording explain, and whether the search ended for that; empty where
    they explain less than was found."""
    told = f" {found.disagreement[:1].upper()}{found.disagreement[1:]}." if found.disagreement else ""
    if told and found.accepted:
        told += " That leaves no more than all that was found, which may only stand for it."
    if found.stopped == RECORDINGS_DIFFER:
        told += f" The search ended early: {RECORDINGS_DIFFER}. trace.by_recording=false searches on."
    return told


def comes_first(found: Trace) -> bool:
    """Whether some parameter differs by recording, and no name is left beside it: nothing was accepted, or
    each name is refuted."""
    refuted = {effect for effect, instead in _in_place(found).items() if _more(instead[0], found)}
    differs = any(one.status == PASSED and not one.in_place_of for one in found.by_recording)
    return differs and refuted >= {one.name for one in found.accepted}


def _in_place(found: Trace) -> dict[str, list[DifferingParameter]]:
    """The parameters that explain as much, by recording, in the place of each accepted effect, the best
    first."""
    every: dict[str, list[DifferingParameter]] = {}
    for one in found.by_recording:
        if one.status == PASSED and one.in_place_of:
            every.setdefault(one.in_place_of, []).append(one)
    return every


def _more(one: DifferingParameter, found: Trace) -> bool:
    """Whether it explains more than the effect in whose place it stands."""
    return found.rules.passes(one.gain, one.p_value)


def _refutes(one: DifferingParameter, values: str) -> str:
    """That a parameter by recording, with its ``values`` if they are to be told, explains more than an
    accepted effect in its place."""
    return (
        f" But {one.parameter} that differs by recording{values} leaves {share(one.gain)} less "
        f"error in the place of {one.in_place_of} (p {probability(one.p_value, '= ')}): that name is "
        "refuted."
    )


def _values_of(one: DifferingParameter) -> str:
    """The value in each recording; the error of a gauge is against the first one, where it is zero."""
    values = one.values
    known = [record for record, v in values.items() if is_error_of_gauge(one.parameter) and not v.value]
    told = [f"{estimated(v.value, v.std, v.unit)} in {r}" for r, v in values.items() if r not in known]
    return listed(told) + (f" against {listed(known)}" if known else "")


def _differs(one: DifferingParameter) -> str:
    values = _values_of(one)
    alike = f"; these records cannot tell it from {listed(one.alike)}" if one.alike else ""
    return (
        f" {one.parameter} differs by recording, {values}: that leaves {share(one.gain)} less error "
        f"(p {probability(one.p_value, '= ')}){alike}. {_how_to_go_on(one)}"
    )


def _how_to_go_on(one: DifferingParameter) -> str:
    """The setting that fits each value; of a gauge, what puts its reading right in each record."""
    if not is_error_of_gauge(one.parameter):
        return f"parameters.{one.parameter}.by=record fits each."
    each = [f"{put_right(one.parameter, v.value)} in {record}" for record, v in one.values.items() if v.value]
    return f"A gauge or an amplifier may have another range, which {listed(each)} puts right."


def _bent(one: DifferingParameter, found: Trace) -> str:
    """That what is still missing may bend the parameter another way in each recording; empty where little is.

    The best parameters of a model that lacks something depend on how the machine was driven. Source: White
    (1982), Maximum likelihood estimation of misspecified models, Econometrica 50(1), 1-25.
    """
    floor = {name: math.hypot(least.value, least.simulation) for name, least in found.noise_floor.items()}
    left = ((rmse, floor[name]) for name, rmse in one.held_out_rmse.items())
    times = max((rmse / least if least else math.inf for rmse, least in left), default=0.0)
    if times <= found.rules.far:
        return ""
    return (
        f" The error is still {multiple(times)} what noise and simulation alone leave, so {one.parameter} "
        "may be the same in all, and what is missing bends it another way in each."
    )
