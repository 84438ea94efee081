"""Makes a model from the names in a config."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from hybridid.declarations import Signal
from hybridid.effects.effect import Effect
from hybridid.effects.library import effect_named
from hybridid.model.groups import Groups, check_groups
from hybridid.model.model import Model
from hybridid.naming import listed, unknown
from hybridid.plants.complete import check_plant
from hybridid.plants.plant import Plant

ADJUSTABLE = ("guess", "lower", "upper", "fixed")


def compose(
    plant: Plant,
    effects: Iterable[str | Effect] = (),
    adjustments: Mapping[str, Mapping[str, float]] | None = None,
    channels: Iterable[Signal] = (),
    by_record: Iterable[str] = (),
    groups: Groups | None = None,
) -> Model:
    """A model from names: ``"viscous"``, ``"viscous@carriage"``, ``"module:NAME@port"``.

    ``channels`` are the auxiliary channels of the records that effects may see, ``by_record`` the parameters
    of the plant that each record gives, ``groups`` the parameters that are estimated for each group of
    records.

    Raises:
        OwnCodeError: if the plant lacks a declaration.
        ValueError: if an effect or port is unknown, or an adjustment names no parameter
            of the model or gives something else than guess, lower, upper, fixed; if ``groups`` names
            no parameter that can be estimated.
    """
    check_plant(plant)
    groups = dict(groups or {})
    model = Model(
        plant,
        adjustments=dict(adjustments or {}),
        channels=tuple(channels),
        by_record=tuple(by_record),
        groups=groups,
    )
    for entry in effects:
        if isinstance(entry, Effect):
            model = model.plus(entry)
            continue
        name, at, port = entry.partition("@")
        if at and not port:
            raise ValueError(
                f"effect {entry!r} names no port; ports: {listed([p.name for p in plant.ports])}"
            )
        kind = plant.port(port).kind if port else None
        model = model.plus(effect_named(name, model.signals, kind), port or None)
    whole = replace(model, groups={}).parameters
    check_groups(groups, whole)
    known = [p.name for p in whole]
    for name, changes in model.adjustments.items():
        if name not in known:
            raise ValueError(unknown("parameter", name, known))
        for key in changes:
            if key not in ADJUSTABLE:
                raise ValueError(unknown(f"setting of parameter {name}", key, ADJUSTABLE))
    return model
