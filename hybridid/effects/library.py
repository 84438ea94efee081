"""The library of effects: one literal tuple, and the way to find an effect by name."""

from __future__ import annotations

from collections.abc import Iterable

from hybridid.blame import imported
from hybridid.declarations import PortKind, Signal
from hybridid.effects import (
    actuator,
    capacity,
    contact,
    dampers,
    delay,
    disturbance,
    elastic,
    flows,
    friction,
    heat_loss,
    hysteresis,
    inertia,
    limits,
    load_friction,
    paths,
    play_friction,
    presliding,
    sensors,
    supply,
    varying_drive,
    varying_friction,
    varying_inertia,
)
from hybridid.effects.channel_friction import EFFECTS_OVER
from hybridid.effects.composed import composed_named
from hybridid.effects.effect import Effect
from hybridid.naming import unknown

EFFECTS: tuple[Effect, ...] = (
    friction.OFFSET,
    friction.VISCOUS,
    friction.COULOMB,
    friction.STRIBECK,
    friction.ASYMMETRIC_VISCOUS,
    friction.ASYMMETRIC_COULOMB,
    friction.QUADRATIC_DRAG,
    load_friction.LOAD_FRICTION,
    load_friction.LOAD_STRIBECK,
    load_friction.TWO_SIDED_LOAD_FRICTION,
    load_friction.INPUT_SCALED_FRICTION,
    presliding.DAHL,
    presliding.LUGRE,
    hysteresis.BOUC_WEN,
    hysteresis.HARDENING_HYSTERESIS,
    play_friction.FRICTION_BEHIND_PLAY,
    varying_friction.POSITION_FRICTION,
    varying_friction.CYCLIC_FRICTION,
    varying_friction.FRICTION_BEYOND_GAP,
    varying_friction.FRICTION_DRIFT,
    varying_friction.WARMING_FRICTION,
    varying_friction.ASYMMETRIC_DAMPER,
    dampers.EDDY_BRAKE,
    dampers.CENTRIFUGAL_BRAKE,
    dampers.POSITION_DAMPING,
    dampers.BLOW_OFF_VALVE,
    disturbance.COGGING,
    disturbance.PERIODIC_DISTURBANCE,
    elastic.LINEAR_STIFFNESS,
    elastic.PRELOADED_SPRING,
    elastic.CUBIC_STIFFNESS,
    elastic.FREE_PLAY,
    elastic.MAXWELL,
    elastic.SECOND_MAXWELL,
    elastic.THIRD_MAXWELL,
    elastic.GRAVITY,
    elastic.DETENT,
    contact.END_STOP,
    contact.WHEEL_LIFT_OFF,
    flows.STEADY_LEAK,
    flows.LINEAR_LEAK,
    flows.ORIFICE_LEAK,
    flows.OVERFLOW,
    flows.OVERFLOW_INTO,
    flows.PERIODIC_FLOW,
    capacity.SIDE_CAPACITY,
    heat_loss.NATURAL_CONVECTION,
    heat_loss.THERMAL_RADIATION,
    supply.FALLING_SUPPLY,
    inertia.ADDED_INERTIA,
    varying_inertia.VARYING_INERTIA,
    varying_inertia.CYCLIC_INERTIA,
    inertia.FLEXIBLE_MODE,
    inertia.BACKLASH,
    limits.BACK_EMF_LIMIT,
    varying_drive.VARYING_FORCE_FACTOR,
    varying_drive.TORQUE_RIPPLE,
    paths.INPUT_GAIN,
    delay.INPUT_DELAY,
    paths.INPUT_LAG,
    limits.INPUT_SATURATION,
    limits.INPUT_DEAD_ZONE,
    actuator.INPUT_NONLINEARITY,
    actuator.INPUT_RATE_LIMIT,
    paths.SENSOR_LAG,
    paths.INPUT_RECORD_LAG,
    paths.SENSOR_SCALE,
    paths.SENSOR_OFFSET,
    sensors.SENSOR_NONLINEARITY,
    sensors.SENSOR_PERIODIC_ERROR,
)


def library_for(channels: Iterable[Signal]) -> tuple[Effect, ...]:
    """The library, and the effects that follow one of ``channels``."""
    return (*EFFECTS, *(over(channel) for channel in channels for over in EFFECTS_OVER))


def effect_named(name: str, channels: Iterable[Signal] = (), at: PortKind | None = None) -> Effect:
    """The effect called ``name``: an id of the library or of a composed law, or ``module.path:NAME`` of one's
    own.

    ``channels`` are the inputs and auxiliary channels that the effects of the library may follow. ``at`` is
    the kind of port for a composed law, as ``composed_named`` has it.

    Raises:
        ValueError: if there is no such effect; the message gives the nearest name.
    """
    if ":" in name:
        return _imported(name)
    known = tuple(channels)
    by_id = {effect.id: effect for effect in library_for(known)}
    law = by_id.get(name) or composed_named(name, known, at=at)
    if law is not None:
        return law
    raise ValueError(unknown("effect", name, [*by_id, "module:NAME of your own"]))


def _imported(name: str) -> Effect:
    effect = imported(name, "effect")
    if not isinstance(effect, Effect):
        raise ValueError(f"effect {name} is a {type(effect).__name__}, not a hybridid.effects.effect.Effect")
    return effect
