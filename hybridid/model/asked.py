"""What a plant and its effects give when they are asked for their equations, checked.

Their code is often the user's own: whatever it raises, and whatever it gives that is no equation, becomes an
``OwnCodeError`` that names file, line and function.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from types import SimpleNamespace
from typing import Any

import casadi as ca

from hybridid.blame import blame, blamed_on
from hybridid.effects.effect import Effect, Local
from hybridid.naming import listed, unknown
from hybridid.plants.plant import Load, Motion, Plant

Symbols = tuple[SimpleNamespace, SimpleNamespace, SimpleNamespace]
"""States, inputs and parameters of a plant by name."""


def motion_of(plant: Plant, at: Symbols) -> dict[str, Motion]:
    """Position and velocity of every effort port and flow port."""
    given = _mapping(plant.motion, [port.name for port in plant.equation_ports], "port", *at)
    for name, moved in given.items():
        if not isinstance(moved, Motion):
            blame(plant.motion, f"gives {_kind(moved)} for port {name}, expected Motion(position, velocity)")
    return {name: _motion(plant, name, moved) for name, moved in given.items()}


def _motion(plant: Plant, name: str, moved: Motion) -> Motion:
    position, velocity = (_scalar(value, name, plant.motion) for value in (moved.position, moved.velocity))
    if moved.acceleration is None:
        return Motion(position, velocity)
    return Motion(position, velocity, _scalar(moved.acceleration, name, plant.motion))


def rates_of(plant: Plant, at: Symbols, efforts: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
    """The time derivative of every state of the plant."""
    return scalars_of(plant.derivative, [state.name for state in plant.states], "state", *at, dict(efforts))


def outputs_of(plant: Plant, at: Symbols, efforts: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
    """Every output of the plant; ``efforts`` are the sums at its ports."""
    names = [signal.name for signal in plant.outputs]
    with blamed_on(plant.sensed):
        sensed = plant.sensed(*at, dict(efforts))
    apart = [name for name in names if isinstance(sensed, Mapping) and name in sensed]
    others = [name for name in names if name not in apart]
    if others and type(plant).output is Plant.output:
        blame(type(plant), f"plant {plant.name} has no method output, which gives {listed(others)}")
    found = scalars_of(plant.sensed, apart, "output", *at, dict(efforts))
    return found | scalars_of(plant.output, others, "output", *at)


def loads_of(plant: Plant, at: Symbols) -> dict[str, Load]:
    """What every port carries that declares it."""
    declared = [port.name for port in plant.equation_ports if port.carries]
    given = _mapping(plant.loads, declared, "port that declares a drive, load or level", *at)
    for name, load in given.items():
        if not isinstance(load, Load):
            blame(plant.loads, f"gives {_kind(load)} for port {name}, expected Load(drive, load, level)")
    return {
        name: Load(*(_scalar(value, name, plant.loads) for value in (load.drive, load.load, load.level)))
        for name, load in given.items()
    }


def law_of(effect: Effect, at: Local) -> ca.SX:
    """The effort of an effect, or what it adds to a signal."""
    with blamed_on(effect.law):
        given = effect.law(at)
    return _scalar(given, f"the law of effect {effect.id}", effect.law)


def dynamics_of(effect: Effect, at: Local) -> dict[str, ca.SX]:
    """The time derivative of every state of an effect."""
    if effect.dynamics is None:
        return {}
    return scalars_of(effect.dynamics, [state.name for state in effect.states], "state", at)


def check_numbers(function: ca.Function, owner: object, what: str) -> None:
    """Whether all constants of a function are numbers: ``math.sin`` of a symbol is NaN.

    Raises:
        OwnCodeError: if not; blames ``owner``, whose equations are called ``what``.
    """
    for k in range(function.n_instructions()):
        if function.instruction_id(k) == ca.OP_CONST and math.isnan(function.instruction_constant(k)):
            blame(
                owner,
                f"{what} hold a NaN: math and numpy cannot take symbols; write casadi.sin, casadi.sqrt "
                "and so on",
            )


def _mapping(
    function: Callable[..., Any], names: Iterable[str], what: str, *arguments: object
) -> dict[str, Any]:
    """What ``function`` gives, by ``names``: all of them and no other."""
    wanted = list(names)
    with blamed_on(function):
        given = function(*arguments)
    if not isinstance(given, Mapping):
        blame(function, f"gives {_kind(given)}, expected a value for each {what}: {listed(wanted)}")
    for name in given:
        if name not in wanted:
            blame(function, f"gives {unknown(what, name, wanted)}")
    missing = [name for name in wanted if name not in given]
    if missing:
        blame(function, f"gives nothing for {what} {listed(missing)}")
    return dict(given)


def scalars_of(
    function: Callable[..., Any], names: Iterable[str], what: str, *arguments: object
) -> dict[str, ca.SX]:
    """What ``function`` gives for each of ``names``: one expression each.

    Raises:
        OwnCodeError: if it fails, or gives something else.
    """
    given = _mapping(function, names, what, *arguments)
    return {name: _scalar(value, f"{what} {name}", function) for name, value in given.items()}


def _scalar(value: Any, what: str, function: Callable[..., Any]) -> ca.SX:
    """One expression in CasADi's SX."""
    if isinstance(value, str | bytes | list | tuple | Mapping | ca.MX):
        blame(function, f"gives {_kind(value)} for {what}, expected one expression in casadi.SX")
    try:
        found = ca.SX(value)
    except (NotImplementedError, TypeError, RuntimeError):
        blame(function, f"gives {_kind(value)} for {what}, expected one expression in casadi.SX")
    if found.shape != (1, 1):
        blame(function, f"gives {found.shape[0]} x {found.shape[1]} expressions for {what}, expected one")
    return found


def _kind(value: Any) -> str:
    return "nothing (None)" if value is None else f"a {type(value).__name__}"
