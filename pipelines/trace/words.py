"""A trace's verdict and numbers in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hybridid.naming import listed
from hybridid.quantities import estimated, percent, quantity, share

Data = Mapping[str, Any]
VERDICTS = {
    "effect_found": "effect found",
    "ambiguous": "ambiguous",
    "nothing_missing": "nothing missing",
    "unexplained": "unexplained",
}


def sentence(data: Data) -> str:
    """The verdict of ``trace.json`` in one sentence."""
    accepted = data["accepted"]
    where = f"on held-out horizons of {data['horizon']:g} s ({data['provenance']})"
    if data["verdict"] == "nothing_missing":
        return f"Nothing that can be found is missing: {_none_passes(data, where)}"
    if data["verdict"] == "unexplained":
        return (
            f"Something is missing that none of the {len(data['rejected'])} effects tried explains: "
            f"structure remains {listed(data['remains'])}, {where}."
        )
    them = "them" if len(accepted) > 1 else "it"
    lacked = listed([_named(entry) for entry in accepted])
    return f"The model lacked {lacked}: with {them} the RMSE {where} falls {_fall(data)}.{_rest(data)}"


def outcome(data: Data) -> str:
    """What the completeness check says."""
    if data["completeness"]["complete"]:
        return f"nothing worth {percent(data['rules']['worth'])} that it could find is left"
    if not data["remains"]:
        return "a gain that does not survive other ways of solving the equations"
    return "it finds what no effect in the library names"


def estimates(parameters: Mapping[str, Data]) -> list[str]:
    """``f_v = 73.4 ± 3.2 N·s/m`` for each parameter."""
    return [f"{name} = {estimated(p['value'], p['std'], p['unit'])}" for name, p in parameters.items()]


def _none_passes(data: Data, where: str) -> str:
    """Why nothing was accepted; a gain that was refused is told, or the sentence would hide it."""
    tried, worth = data["rejected"], data["rules"]["worth"]
    if not tried:
        return f"{data['stopped']} {where}."
    fails = f"none of the {len(tried)} effects tried lowers the error {where} by {percent(worth)}"
    most = max(tried, key=lambda entry: entry["gain"])
    if most["gain"] < worth:
        return f"{fails}."
    return (
        f"{fails} and passes every test. The largest gain, {share(most['gain'])} with {most['effect']} at "
        f"{most['port']}, is refused: {most['reason']}."
    )


def _named(entry: Data) -> str:
    """An accepted effect with its parameters, or the class that it stands for."""
    values = ", ".join(estimates(entry["parameters"]))
    if len(entry["class"]) > 1:
        members = ", ".join(entry["class"])
        return f"one of {{{members}}} at {entry['port']}, which these records cannot tell apart"
    return f"{entry['effect']} at {entry['port']} ({values})"


def _fall(data: Data) -> str:
    """From where to where, for each output."""
    first, last = data["path"][0]["held_out_rmse"], data["path"][-1]["held_out_rmse"]
    falls = []
    for name, before in first.items():
        unit, after = data["noise_floor"][name]["unit"], last[name]
        change = f"{percent(abs(1 - after / before), 0)} {'less' if after <= before else 'more'}"
        falls.append(f"from {quantity(before, unit, 3)} to {quantity(after, unit, 3)} ({change}) in {name}")
    return listed(falls)


def _rest(data: Data) -> str:
    if not data["remains"]:
        return ""
    return f" Structure remains {listed(data['remains'])} that no effect in the library explains."
