"""Friction whose level follows a measured channel, such as a temperature, a pressure or another axis."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from hybridid.declarations import Signal
from hybridid.effects.dimension import Dimension
from hybridid.effects.effect import Effect, EffectParameter, Local


@dataclass(frozen=True)
class _Level:
    """``k (c - c_0) sign(v)`` with c the channel of that name. Another process finds a class by name."""

    channel: str

    def __call__(self, at: Local) -> ca.SX:
        return at.p.k * (getattr(at.channels, self.channel) - at.p.c_0) * at.sign


def friction_over(channel: Signal) -> Effect:
    """Coulomb friction whose level is linear in ``channel``, with the id ``friction_over_<channel>``."""
    unit = channel.unit
    return Effect(
        id=f"friction_over_{channel.name}",
        kind="effort",
        title=f"friction whose level follows {channel.name}",
        equation=f"F = k (c - c_0) sign(v),  c = {channel.name}",
        law=_Level(channel.name),
        parameters=(
            EffectParameter(
                "k",
                Dimension(effort=1, channel=-1, channel_unit=unit),
                f"change of the Coulomb level with {channel.name}",
                guess=0.0,
                nests=True,
            ),
            EffectParameter(
                "c_0",
                Dimension(channel=1, channel_unit=unit),
                f"{channel.name} at which the level is that of Coulomb friction",
                guess=0.0,
                absolute=True,
                fixed=True,
                sought="mean",
            ),
        ),
        source=(
            "Bittencourt, Gunnarsson (2012), ASME J. Dyn. Syst. Meas. Control 134(5), 051013 (friction over "
            "temperature), to first order in the channel"
        ),
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
