"""A trace's verdict and numbers in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hybridid.plotting.units import engineering

Data = Mapping[str, Any]
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
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


def listed(items: Sequence[str]) -> str:
    """``a, b and c``."""
    return ", ".join(items[:-1]) + (" and " if len(items) > 1 else "") + items[-1] if items else "nothing"


def quantity(value: float | None, unit: str, digits: int = 4) -> str:
    """``0.585 mm`` for 5.85e-4 m."""
    if value is None:
        return "diverges"
    factor, printed = engineering(abs(value), unit)
    return f"{value * factor:.{digits}g} {printed}".replace("-", "−")


def probability(p: float, equals: str = "") -> str:
    """A p-value to two digits, behind ``equals``; below what its normal theory can mean, only that."""
    if p < 1e-15:
        return "< 10⁻¹⁵"
    return equals + (f"{p:.2g}" if p >= 1e-3 else power(p))


def estimated(parameter: Data) -> str:
    """``73.4 ± 3.2 N·s/m``: the value and half its 95 % interval."""
    value, std, unit = parameter["value"], parameter["std"], parameter["unit"]
    unit = "" if unit == "1" else f" {unit}"
    if std is None:
        return f"{value:.5g}{unit} ± ?".replace("-", "−")
    return f"{value:.5g} ± {1.96 * std:.2g}{unit}".replace("-", "−")


def percent(share_of_one: float) -> str:
    """``5 %`` for 0.05."""
    return f"{100 * share_of_one:g} %"


def power(value: float | None) -> str:
    """``2.09·10⁻⁷``: three digits and a power of ten."""
    if value is None:
        return ""
    digits, _, exponent = f"{value:.2e}".partition("e")
    return f"{digits}·10{str(int(exponent)).translate(_SUPERSCRIPT)}"


def squared(unit: str) -> str:
    """``m²`` for m, ``(m/s)²`` for m/s."""
    return f"{unit}²" if unit.isalpha() else f"({unit})²"


def share(gain: float) -> str:
    """``36.1 %`` less, or how much more."""
    return "diverges" if gain <= -1 else f"{100 * gain:.1f} %".replace("-", "−")


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
    values = ", ".join(f"{name} = {estimated(p)}" for name, p in entry["parameters"].items())
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
        change = f"{100 * abs(1 - after / before):.0f} % {'less' if after <= before else 'more'}"
        falls.append(f"from {quantity(before, unit, 3)} to {quantity(after, unit, 3)} ({change}) in {name}")
    return listed(falls)


def _rest(data: Data) -> str:
    if not data["remains"]:
        return ""
    return f" Structure remains {listed(data['remains'])} that no effect in the library explains."
