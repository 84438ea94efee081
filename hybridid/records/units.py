"""Units as people write them, converted by pint: ``deg``, ``mm/s2``, ``Nm``, ``L/min``."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pint

_ANGLES = ("radian", "degree", "arcminute", "arcsecond", "turn", "revolutions_per_minute")
_SPELT = (
    (re.compile(r"\b([mkM]?N)m\b"), r"\1*m"),
    (re.compile(r"([A-Za-z])(\d)"), r"\1^\2"),
    (re.compile(r"\brev\b"), "turn"),
    (re.compile(r"\b(kmh|kmph)\b"), "km/h"),
    (re.compile(r"\bU/min\b"), "turn/min"),
)


def factor(unit: str, into: str) -> float | None:
    """What turns a number in ``unit`` into one in ``into``; None where no factor does: where they are of
    different quantities, where either is no unit, or from °C to K."""
    import pint

    try:
        one, target = _registry().Unit(_spelt(unit)), _registry().Unit(_spelt(into))
        if not one.is_compatible_with(target) or _is_angle(one) != _is_angle(target):
            return None
        zero, step = (_registry().Quantity(value, one).to(target).magnitude for value in (0.0, 1.0))
    except (pint.PintError, ValueError, TypeError, AttributeError, AssertionError):  # text that is no unit
        return None
    return None if zero else float(f"{step:.14g}")


def is_unit(text: str) -> bool:
    """Whether ``text`` is a unit."""
    return factor(text, text) is not None


def _spelt(unit: str) -> str:
    for pattern, replacement in _SPELT:
        unit = pattern.sub(replacement, unit)
    return unit if unit.strip() else "no unit"


def _is_angle(unit: pint.Unit) -> bool:
    """Whether it counts turns or radians, which pint holds to be pure numbers, as counts and shares are."""
    return any(word.endswith(_ANGLES) for word in re.findall(r"\w+", str(unit)))


@cache
def _registry() -> pint.UnitRegistry:
    import pint

    return pint.UnitRegistry()
