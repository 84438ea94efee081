"""Friction that follows a measured channel, such as a temperature, a pressure, a current or another axis."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import casadi as ca

from hybridid.declarations import Signal
from hybridid.effects.dimension import DAMPING, EFFORT, Dimension
from hybridid.effects.effect import Effect, EffectParameter, Local

_SOURCE = (
    "Bittencourt, Gunnarsson (2012), ASME J. Dyn. Syst. Meas. Control 134(5), 051013 (friction over "
    "temperature), to first order in the channel"
)


@dataclass(frozen=True)
class _Linear:
    """``k (c - c_0)`` times sign(v) or v, with c the channel of that name. Another process finds a class by
    name."""

    channel: str
    motion: Literal["sign", "velocity"]

    def __call__(self, at: Local) -> ca.SX:
        return at.p.k * (getattr(at.channels, self.channel) - at.p.c_0) * getattr(at, self.motion)


def _parameters(
    channel: Signal, changes: str, declared: str, amplitude: Dimension
) -> tuple[EffectParameter, ...]:
    """``k``, by how much an amplitude changes with the ``channel``, and ``c_0``, its mean: there the
    amplitude is that of the ``declared`` friction."""
    return (
        EffectParameter(
            "k",
            replace(amplitude, channel=-1, channel_unit=channel.unit),
            f"change of the {changes} of {declared} friction with {channel.name}",
            guess=0.0,
            nests=True,
        ),
        EffectParameter(
            "c_0",
            Dimension(channel=1, channel_unit=channel.unit),
            f"{channel.name} at which the {changes} is that of {declared} friction",
            guess=0.0,
            absolute=True,
            fixed=True,
            sought="mean",
        ),
    )


def friction_over(channel: Signal) -> Effect:
    """Coulomb friction whose level is linear in ``channel``, with the id ``friction_over_<channel>``."""
    return Effect(
        id=f"friction_over_{channel.name}",
        kind="effort",
        title=f"friction whose level follows {channel.name}",
        equation=f"F = k (c - c_0) sign(v),  c = {channel.name}",
        law=_Linear(channel.name, "sign"),
        parameters=_parameters(channel, "level", "Coulomb", EFFORT),
        source=_SOURCE,
        pattern=(
            f"a step where the velocity changes sign, whose height is a straight line over {channel.name}; "
            "the level at c_0 is Coulomb friction's. A drift follows the time, also where the channel returns"
        ),
        look_alikes=(
            "friction_drift",
            "warming_friction",
            "coulomb",
            "input_scaled_friction",
            "position_friction",
        ),
        separating_experiment=(
            f"the same slow strokes at three constant values of {channel.name}, in an order that is not that "
            "of their size: the height of the step follows the channel and not the time"
        ),
        channels=(channel.name,),
    )


def viscous_over(channel: Signal) -> Effect:
    """Viscous friction whose coefficient is linear in ``channel``, with the id ``viscous_over_<channel>``: a
    grease that is stiff when it is cold, a damper or an eddy-current brake that a current sets."""
    return Effect(
        id=f"viscous_over_{channel.name}",
        kind="effort",
        title=f"viscous friction that follows {channel.name}",
        equation=f"F = k (c - c_0) v,  c = {channel.name}",
        law=_Linear(channel.name, "velocity"),
        parameters=_parameters(channel, "slope", "viscous", DAMPING),
        source=_SOURCE,
        pattern=(
            f"friction in proportion to the velocity, whose slope is a straight line over {channel.name}; at "
            "c_0 it is that of viscous friction. A drift follows the time, also where the channel returns"
        ),
        look_alikes=(
            f"friction_over_{channel.name}",
            "friction_drift",
            "warming_friction",
            "viscous",
            "position_damping",
            "quadratic_drag",
        ),
        separating_experiment=(
            f"strokes at two speeds and three constant values of {channel.name}, not in the order of their "
            "size: the change with the channel grows with the speed, as that of a level does not"
        ),
        channels=(channel.name,),
    )


EFFECTS_OVER = (friction_over, viscous_over)
"""Each makes the effect of the library that follows one channel."""
