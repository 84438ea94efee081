"""Laws with a kink, smoothed over a small declared width: hyperbolas, and for the modulus a tanh.

``width`` is a scale, not an exact edge. At ten widths from the kink of a hyperbola, the difference to the
sharp law is 1/40 of the width; it decays with the inverse of the distance, that of the tanh exponentially.
"""

from __future__ import annotations

import casadi as ca


def ramp(x: ca.SX, width: ca.SX | float) -> ca.SX:
    """``(x + √(x² + w²)) / 2``: 0 left of the origin, x right of it. Increasing, slope below 1."""
    return 0.5 * (x + ca.sqrt(x**2 + width**2))


def pressed(x: ca.SX, width: ca.SX | float) -> ca.SX:
    """The slope of ``ramp``: 0 left of the origin, 1 right of it."""
    return 0.5 * (1 + x / ca.sqrt(x**2 + width**2))


def magnitude(x: ca.SX | float, width: ca.SX | float) -> ca.SX:
    """``x tanh(x / w)``: |x|, zero at the origin and never above |x|; at 2 w it lacks 0.07 w."""
    return x * ca.tanh(x / width)


def saturated(x: ca.SX, limit: ca.SX | float, width: ca.SX | float) -> ca.SX:
    """``(√((x + l)² + w²) - √((x - l)² + w²)) / 2``: x clipped to ±l. Odd in x, exactly zero for l = 0."""
    return 0.5 * (ca.sqrt((x + limit) ** 2 + width**2) - ca.sqrt((x - limit) ** 2 + width**2))


def dead_zone(x: ca.SX, half_gap: ca.SX | float, width: ca.SX | float) -> ca.SX:
    """``x - saturated(x)``: 0 inside ±g, ``x ∓ g`` outside."""
    return x - saturated(x, half_gap, width)


def engagement(x: ca.SX, half_gap: ca.SX | float, width: ca.SX | float) -> ca.SX:
    """The slope of ``dead_zone``: 0 inside ±g, 1 outside."""
    above, below = x + half_gap, x - half_gap
    inside = above / ca.sqrt(above**2 + width**2) - below / ca.sqrt(below**2 + width**2)
    return 1.0 - 0.5 * inside
