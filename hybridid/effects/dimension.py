"""``Dimension``: a unit as powers of a port's effort, position and time."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from hybridid.declarations import Port
from hybridid.quantities import superscript

_NAMED = {"N·s²/m": "kg", "N·m·s²/rad": "kg·m²", "Nm·s²/rad": "kg·m²"}
"""Units that have a name of their own (rad counts as 1)."""
_FACTOR = re.compile(r"(?P<base>[^\d\s·/()*^⁰¹²³⁴-⁹]+|1)(?P<power>[¹²³⁴-⁹]?)")
_DIGITS = str.maketrans("¹²³⁴⁵⁶⁷⁸⁹", "123456789")
LARGEST_DENOMINATOR = 12
"""Of a power that is no integer."""


@dataclass(frozen=True)
class Dimension:
    """A unit as powers of a port's effort, position and time: N·s/m is (1, -1, 1).

    ``channel`` is the power of ``channel_unit``, the unit of an input or channel that an effect sees. N/°C is
    ``Dimension(effort=1, channel=-1, channel_unit="°C")``. No port knows the scale of that unit: it is 1.
    ``called`` names the unit where the powers would be read otherwise: 1/s may be taken for rad/s.
    """

    effort: float = 0
    position: float = 0
    time: float = 0
    channel: float = 0
    channel_unit: str = "1"
    called: str = ""

    def scale(self, port: Port) -> float:
        """The natural magnitude of such a quantity at ``port``, in SI units."""
        return (
            port.effort_scale**self.effort * port.position_scale**self.position * port.time_scale**self.time
        )

    def times(self, other: Dimension, power: int = 1) -> Dimension:
        """This dimension times ``other`` to the ``power``; only one of them may have a channel's unit."""
        return Dimension(
            self.effort + power * other.effort,
            self.position + power * other.position,
            self.time + power * other.time,
            self.channel + power * other.channel,
            other.channel_unit if other.channel else self.channel_unit,
        )

    def unit(self, port: Port) -> str:
        """The unit's name at ``port``, such as ``N·s/m``; ``"1"`` if dimensionless.

        What effort and position have in common cancels: m³/s over m is m²/s.
        """
        if self.called:
            return self.called
        powers: dict[str, float] = {}
        for name, power in (
            (port.effort_unit, self.effort),
            (port.position_unit, self.position),
            ("s", self.time),
            (self.channel_unit, 0 if self.channel_unit == "1" else self.channel),
        ):
            for base, exponent in _factors(name):
                powers[base] = powers.get(base, 0) + power * exponent
        above = [_power(name, n) for name, n in powers.items() if n > 0]
        below = [_power(name, -n) for name, n in powers.items() if n < 0]
        text = "·".join(above) or "1"
        if below:
            simple = len(below) == 1 and not set(below[0].partition("^")[0]) & set("/·")
            text += f"/{below[0]}" if simple else f"/({'·'.join(below)})"
        return _NAMED.get(text, text)


def _factors(unit: str) -> list[tuple[str, int]]:
    """The factors of a unit with their powers: ``m³/s`` is m to 3 and s to -1.

    A unit that is written in another way is one factor.
    """
    above, slash, below = unit.partition("/")
    sides = [(above, 1)] + ([(below.removeprefix("(").removesuffix(")"), -1)] if slash else [])
    found = [(_FACTOR.fullmatch(word), sign) for side, sign in sides for word in side.split("·")]
    if not all(match for match, _ in found):
        return [(unit, 1)]
    return [
        (match["base"], sign * int((match["power"] or "1").translate(_DIGITS)))
        for match, sign in found
        if match and match["base"] != "1"
    ]


def _power(name: str, exponent: float) -> str:
    """``s²``, or ``s^(2/3)`` where an effect of one's own has a power that is no integer."""
    base = f"({name})" if exponent > 1 and set(name) & set("/·²³") else name
    fraction = Fraction(exponent).limit_denominator(LARGEST_DENOMINATOR)
    if fraction.denominator > 1:
        return f"{base}^({fraction})"
    return base if fraction == 1 else base + superscript(int(fraction))


ONE = Dimension()
TIME = Dimension(time=1)
FREQUENCY = Dimension(time=-1, called="Hz")
EFFORT = Dimension(effort=1)
POSITION = Dimension(position=1)
VELOCITY = Dimension(position=1, time=-1)
VELOCITY_SQUARED = Dimension(position=2, time=-2)
STIFFNESS = Dimension(effort=1, position=-1)
DAMPING = Dimension(effort=1, position=-1, time=1)
INERTIA = Dimension(effort=1, position=-1, time=2)
DRAG = Dimension(effort=1, position=-2, time=2)
