"""Units as an axis prints them: ``position [mm]``, with the engineering prefix that reads best."""

from __future__ import annotations

import math
import re

_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "µ", -9: "n", -12: "p"}
# Symbols that take a prefix; the lookahead keeps "m²", "min" or "kg" as they are, because a
# prefix in front of them would mean another factor or another unit.
_PREFIXABLE = re.compile(r"^(Nm|rad|Hz|Pa|[mNVAWJsTFΩ])(?=$|[·/])")
_DIMENSIONLESS = ("", "1", "-", "–")
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def typeset(unit: str) -> str:
    """``unit`` in print: ``N*s/m^2`` becomes ``N·s/m²``, no unit a dash."""
    if unit.strip() in _DIMENSIONLESS:
        return "–"
    powers = re.sub(r"(?:\^|\*\*)(-?\d+)", lambda found: found[1].translate(_SUPERSCRIPT), unit.strip())
    return powers.replace("*", "·").replace("ohm", "Ω")


def engineering(magnitude: float, unit: str) -> tuple[float, str]:
    """Factor and unit that bring ``magnitude`` (in ``unit``) between 1 and 1000.

    ``engineering(0.0026, "m")`` is ``(1000.0, "mm")``. A unit that takes no prefix keeps its
    name while its numbers are readable, else a power of ten goes in front of it. Seconds get
    no prefix above one: nobody reads kiloseconds.
    """
    printed = typeset(unit)
    if not (math.isfinite(magnitude) and magnitude > 0):
        return 1.0, printed
    # The margin keeps a signal of 0.9999 m in mm and one of 1.0 m in m, whatever its last digit.
    exponent = 3 * math.floor(math.log10(magnitude * (1 + 1e-9)) / 3)
    if _PREFIXABLE.match(printed):
        highest = 0 if printed == "s" else 9
        exponent = min(max(exponent, -12), highest)
        return 10.0**-exponent, _PREFIXES[exponent] + printed
    if -3 <= exponent <= 3:
        return 1.0, printed
    power = f"10{str(exponent).translate(_SUPERSCRIPT)}"
    return 10.0**-exponent, power if printed == "–" else f"{power} {printed}"


def axis_label(name: str, unit: str) -> str:
    """``name [unit]``, as an axis carries it; ``unit`` is already in print."""
    return f"{name} [{unit}]"


def per_root_hertz(unit: str) -> str:
    """Unit of an amplitude spectral density: ``m`` becomes ``m/√Hz``, ``m/s`` ``m/(s·√Hz)``."""
    printed = typeset(unit)
    if printed == "–":
        return "1/√Hz"
    above, slash, below = printed.partition("/")
    return f"{above}/({below.strip('()')}·√Hz)" if slash else f"{above}/√Hz"
