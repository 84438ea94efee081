"""How quantities are printed, the same on a page, in a figure and on the terminal.

A quantity is a number times a unit. Numbers have real minus signs and powers of ten (``2.1·10⁻⁷``); ``None``
and what is not finite become a word. Units take the engineering prefix that reads best.
"""

from __future__ import annotations

import math
import re

DIVERGES = "diverges"
UNKNOWN = "unknown"
NONE = "–"
"""Where there can be no number."""
Z95 = 1.96
"""Half the width of a 95 % interval, in standard errors: the normal distribution's 97.5 % quantile."""

_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "µ", -9: "n", -12: "p"}
# Symbols that take a prefix; the lookahead keeps "m²", "min" or "kg" as they are, because a
# prefix in front of them would mean another factor or another unit.
_PREFIXABLE = re.compile(r"^(Nm|rad|Hz|Pa|[mNVAWJsTFΩ])(?=$|[·/])")
_DIMENSIONLESS = ("", "1", "-", NONE)
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_TINY = 1e-300  # below it a factor to 1 is no floating-point number
_TINY_REST = 1e-8  # what is left of all, below it 100 %
_SMALLEST_P = 1e-15  # below it the tests' normal theory says nothing
_MOST_DIGITS = 12  # a number has hardly more
_DIGITS = 8  # of a value that is known so exactly
_PLACES, _SMALL, _LARGEST = 5, 1e-3, 1e6  # decimals and magnitudes that need no power of ten


def superscript(exponent: int) -> str:
    """``⁻⁷`` for -7."""
    return str(exponent).translate(_SUPERSCRIPT)


def typeset(unit: str) -> str:
    """``unit`` in print: ``N*s/m^2`` becomes ``N·s/m²``, no unit a dash."""
    if unit.strip() in _DIMENSIONLESS:
        return NONE
    powers = re.sub(r"(?:\^|\*\*)(-?\d+)", lambda found: superscript(int(found[1])), unit.strip())
    return powers.replace("*", "·").replace("ohm", "Ω")


def engineering(magnitude: float, unit: str) -> tuple[float, str]:
    """Factor and unit that bring ``magnitude`` (in ``unit``) between 1 and 1000.

    ``engineering(0.0026, "m")`` is ``(1000.0, "mm")``. A unit that takes no prefix keeps its
    name while its numbers are readable, else a power of ten goes in front of it. Seconds get
    no prefix above one: kiloseconds are not in use.
    """
    printed = typeset(unit)
    if not (math.isfinite(magnitude) and magnitude >= _TINY):
        return 1.0, printed
    # The margin keeps a signal of 0.9999 m in mm and one of 1.0 m in m, whatever its last digit.
    exponent = 3 * math.floor(math.log10(magnitude * (1 + 1e-9)) / 3)
    if _PREFIXABLE.match(printed):
        highest = 0 if printed == "s" else 9
        exponent = min(max(exponent, -12), highest)
        return 10.0**-exponent, _PREFIXES[exponent] + printed
    if -3 <= exponent <= 3:
        return 1.0, printed
    power_of_ten = f"10{superscript(exponent)}"
    return 10.0**-exponent, power_of_ten if printed == NONE else f"{power_of_ten} {printed}"


def per_root_hertz(unit: str) -> str:
    """Unit of an amplitude spectral density: ``m`` becomes ``m/√Hz``, ``m/s`` ``m/(s·√Hz)``."""
    printed = typeset(unit)
    if printed == NONE:
        return "1/√Hz"
    above, slash, below = printed.partition("/")
    return f"{above}/({below.strip('()')}·√Hz)" if slash else f"{above}/√Hz"


def squared(unit: str) -> str:
    """``m²`` for m, ``(m/s)²`` for m/s; nothing where there is no unit."""
    printed = typeset(unit)
    if printed == NONE:
        return ""
    return f"{printed}²" if printed.isalpha() else f"({printed})²"


def with_unit(number_in_print: str, unit: str) -> str:
    """``3.2 N·s/m``; ``3.2`` where there is no unit, ``3.2·10⁶`` where it is a power of ten."""
    printed = typeset(unit)
    if printed == NONE:
        return number_in_print
    if not printed.startswith("10"):
        return f"{number_in_print} {printed}"
    return f"({number_in_print})·{printed}" if "±" in number_in_print else f"{number_in_print}·{printed}"


def number(value: float | None, digits: int = 4, missing: str = UNKNOWN) -> str:
    """``value`` to so many significant digits: ``0.0123``, ``123500``, ``−2.1·10⁻⁷``."""
    if value is None or not math.isfinite(value):
        return missing
    rounded = float(f"{value:.{digits}g}")
    mantissa, e, exponent = f"{rounded:.{max(digits, 6)}g}".partition("e")
    return minus(f"{mantissa}·10{superscript(int(exponent))}" if e else mantissa)


def fixed(value: float | None, places: int, missing: str = UNKNOWN) -> str:
    """``value`` to so many decimal places, zero without a sign."""
    return missing if value is None or not math.isfinite(value) else minus(f"{value:z.{places}f}")


def power(value: float | None, digits: int = 3, missing: str = "") -> str:
    """``2.09·10⁻⁷``: so many digits and a power of ten."""
    if value is None or not math.isfinite(value):
        return missing
    if value == 0.0:
        return "0"
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    return minus(f"{mantissa}·10{superscript(int(exponent))}")


def quantity(value: float | None, unit: str, digits: int = 4, missing: str = DIVERGES) -> str:
    """``0.585 mm`` for 5.85e-4 m."""
    if value is None or not math.isfinite(value):
        return missing
    factor, printed = engineering(abs(value), unit)
    return with_unit(number(value * factor, digits), printed)


def span(low: float, high: float, unit: str, digits: int = 4) -> str:
    """``-0.809 to 1.5 m/s``: a range, with one unit for both of its ends."""
    factor, printed = engineering(max(abs(low), abs(high)), unit)
    return with_unit(f"{number(low * factor, digits)} to {number(high * factor, digits)}", printed)


def digits_apart(low: float, high: float, least: int) -> int:
    """Significant digits, ``least`` or more, that show two of the difference between two ends of a range."""
    apart, larger = high - low, max(abs(low), abs(high))
    if not 0 < apart < math.inf:
        return least
    return min(max(least, 2 + _decade(larger) - _decade(apart)), _MOST_DIGITS)


def mean_square(value: float | None, unit: str, missing: str = "") -> str:
    """``2.091·10⁻⁷ m²``: a mean squared error of a signal in ``unit``."""
    printed = power(value, 4)
    return f"{printed} {squared(unit)}".strip() if printed else missing


FAR_FROM_ONE = 1e6
"""|R²| from which its decimals say nothing."""


def r_squared(value: float | None, missing: str = "") -> str:
    """The coefficient of determination R² to six places, for what counts are the nines; of a run that left
    the record by far, as a power of ten."""
    far = value is not None and abs(value) >= FAR_FROM_ONE
    return power(value, 3, missing) if far else fixed(value, 6, missing)


def estimated(value: float | None, std: float | None, unit: str) -> str:
    """``73.4 ± 3.2 N·s/m``: an estimate and half its 95 % interval; ``± ?`` without a standard error."""
    if value is None or not math.isfinite(value):
        return UNKNOWN
    if std is None or not math.isfinite(std):
        return with_unit(f"{number(value, 5)} ± ?", unit)
    return with_unit(_plus_minus(value, Z95 * std), unit)


def mean_and_deviation(mean: float, deviation: float | None, unit: str) -> str:
    """``12.3 ± 0.4 mm``, or the mean alone."""
    if deviation is None or not math.isfinite(deviation):
        return quantity(mean, unit)
    factor, printed = engineering(abs(mean), unit)
    return with_unit(_plus_minus(mean * factor, deviation * factor), printed)


def multiple(times: float) -> str:
    """``2.9 times``, ``546 times``, or that it is more than a thousand."""
    return f"{times:.{1 if times < 100 else 0}f} times" if times < 1000 else "more than a thousand times"


def probability(p: float | None, equals: str = "") -> str:
    """A p-value to two digits, behind ``equals``; below what its normal theory can mean, only that."""
    if p is None or not math.isfinite(p):
        return UNKNOWN
    if p < _SMALLEST_P:
        return f"< 10{superscript(round(math.log10(_SMALLEST_P)))}"
    return equals + (f"{p:.2g}" if p >= 1e-3 else power(p))


def percent(share_of_one: float | None, places: int | None = None, missing: str = UNKNOWN) -> str:
    """``5 %`` for 0.05; with as many places as the number needs, or with ``places``."""
    if share_of_one is None or not math.isfinite(share_of_one):
        return missing
    hundredfold = 100 * share_of_one
    return f"{number(hundredfold, 6) if places is None else fixed(hundredfold, places)} %"


def places_below_all(part: float | None, least: int) -> int:
    """Decimals of ``part`` of one in per cent: ``least``, or as many as keep 99.97 % from reading 100 %."""
    rest = 1.0 if part is None else 200 * (1.0 - abs(part))
    return max(least, math.floor(-math.log10(rest)) + 1) if _TINY_REST < rest < 1 else least


def share(gain: float | None) -> str:
    """``36.1 %`` less, or how much more; an error that at least doubled counts as divergence."""
    return DIVERGES if gain is not None and gain <= -1 else percent(gain, places_below_all(gain, 1))


def change(before: float | None, after: float | None, places: int = 1) -> str:
    """``−36.1 %``: the change as a part of ``before``, ``0.0 %`` for none; empty where either is missing or
    ``before`` is 0."""
    if not before or after is None or not (math.isfinite(before) and math.isfinite(after)):
        return ""
    part = after / before - 1
    said = f"{100 * part:+.{places_below_all(part, places)}f}"
    return f"{minus(said if float(said) else said[1:])} %"


def _plus_minus(value: float, half: float) -> str:
    """``73.4 ± 3.2``: the uncertainty to two digits and the value to the same place (GUM, 7.2.6)."""
    larger = max(abs(value), half)
    if half > _TINY:
        place = 1 - _decade(float(f"{half:.1e}"))
        if place <= _PLACES and larger < _LARGEST:
            return " ± ".join(fixed(round(x, place), max(place, 0)) for x in (value, half))
        exponent = _decade(larger)
        if place + exponent <= _PLACES and not _SMALL <= larger < _LARGEST:
            both = " ± ".join(fixed(x / 10.0**exponent, place + exponent) for x in (value, half))
            return f"({both})·10{superscript(exponent)}"
        if 0 < abs(value) < _LARGEST and place + _decade(abs(value)) < _DIGITS:
            return f"{fixed(value, place)} ± {number(half, 2)}"
    return f"{number(value, 5)} ± {number(half, 2)}"


def _decade(magnitude: float) -> int:
    return math.floor(math.log10(magnitude))


def minus(text: str) -> str:
    """``text`` with real minus signs."""
    return text.replace("-", "−")
