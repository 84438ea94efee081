"""From config to model and fit settings: plant, effects, parameters, estimator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from hybridid.declarations import Signal
from hybridid.effects.effect import Effect
from hybridid.effects.library import library_for
from hybridid.model import Model, compose
from hybridid.plants.plant import Plant
from hybridid.settings.fit import FitSettings
from pipelines.shared.by_group import Grouping, groupings
from pipelines.shared.by_record import MARK, parameters_by_record
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.imports import code_digests, made, named
from pipelines.shared.parameters import adjustments, asked_in, parameters_of

KEYS = ("plant", "channels", "effects", "parameters")


def plant_of(settings: Settings) -> Plant:
    """The plant at the import path ``plant``, which names an instance or a class without arguments.

    Raises:
        ConfigError: if the path names neither.
    """
    plant: Plant = made(settings["plant"], "plant", Plant)
    return plant


def channels_of(settings: Settings) -> tuple[Signal, ...]:
    """``channels``: which auxiliary signals of the records the effects may see, in the order of the config.

    Raises:
        ConfigError: if ``channels`` is anything else than names with units.
    """
    given = settings.get("channels", {})
    if not isinstance(given, Mapping) or not all(isinstance(unit, str) for unit in given.values()):
        raise ConfigError(f"channels is {given!r}: give names with units, as in {{temperature: °C}}")
    return tuple(Signal(str(name), unit) for name, unit in given.items())


def model_of(settings: Settings) -> Model:
    """The case's plant with its effects and adjusted parameters.

    Entries of ``parameters`` for effects that are not selected are checked and then ignored.

    Raises:
        ConfigError: if an effect, port or parameter is unknown, or a number is not allowed.
    """
    plant, channels, by_record = plant_of(settings), channels_of(settings), _by_record(settings)
    entries = effect_entries(settings)
    for entry in entries:
        if ":" in entry:
            named(entry.partition("@")[0], "effect")
    try:
        bare = compose(plant, entries, channels=channels, by_record=by_record)
        names = {p.name for p in bare.parameters}
        parameters = parameters_of(settings)
        given, differing = adjustments(parameters), dict(asked_in(parameters))
        for name in by_record:
            if name in given or name in differing:
                raise ConfigError(f"parameters.{name} is set, but every record gives {name}: leave one out")
        ownable = names | _ownable(plant, [*library_for(channels), *(term.effect for term in bare.terms)])
        for name in (*given, *differing):
            if name not in ownable:
                raise ConfigError(unknown("parameter", name, ownable, allowed=names))
        own = {name: given[name] for name in given if name in names}
        groups = {name: one.names for name, one in groupings(settings, differing).items() if name in names}
        model = compose(plant, entries, own, channels, by_record, groups)
        _ = model.parameters  # raises if bounds contradict each other
    except ConfigError:
        raise
    except ValueError as error:
        raise ConfigError(str(error)) from error
    return model


def searched_model_of(settings: Settings) -> Model:
    """``model_of`` for a search that may add effects: what the config fixes of these stays fixed.

    Raises:
        ConfigError: as ``model_of``.
    """
    model = model_of(settings)
    asked = {name: one.get("fixed") for name, one in adjustments(parameters_of(settings)).items()}
    fixed = {name: {"fixed": value} for name, value in asked.items() if value is not None}
    return replace(model, adjustments={**fixed, **model.adjustments})


def given_of(settings: Settings) -> tuple[Signal, ...]:
    """What every record gives, with its unit, in the order of the model's inputs: parameters of the plant,
    and the weights of parameters that are estimated for each group of records.

    Raises:
        ConfigError: if the plant has no parameter of a name, or the config is wrong.
    """
    by_record = parameters_by_record(settings)
    if _differing(settings):
        return model_of(settings).given
    if not by_record:
        return ()
    try:
        return Model(plant_of(settings), by_record=by_record).given
    except ValueError as error:
        raise ConfigError(str(error)) from error


def groupings_of(settings: Settings, model: Model) -> tuple[Grouping, ...]:
    """The groups of records of each parameter of ``model`` that is estimated for each."""
    if not model.groups:
        return ()
    found = groupings(settings, _differing(settings))
    return tuple(found[name] for name in model.groups)


def weights_of(settings: Settings) -> dict[str, dict[str, float]]:
    """What each record gives beside its known parameters: the weights of all groups, by record and name.

    Raises:
        ConfigError: if the config is wrong.
    """
    if not _differing(settings):
        return {}
    groups = groupings_of(settings, model_of(settings))
    return {
        str(record): {name: weight for one in groups for name, weight in one.weights(str(record)).items()}
        for record in settings["records"]
    }


def _differing(settings: Settings) -> dict[str, Any]:
    """The settings ``by`` of all parameters, by name."""
    return dict(asked_in(parameters_of(settings)))


def _by_record(settings: Settings) -> tuple[str, ...]:
    """The same names, also of a model that was stored without its records."""
    marked = [
        str(n) for n, one in parameters_of(settings).items() if isinstance(one, Mapping) and one.get(MARK)
    ]
    return tuple(dict.fromkeys([*marked, *parameters_by_record(settings)]))


def named_code(settings: Settings) -> dict[str, str]:
    """Digests of the code that the config names: the plant's and the effects' import paths."""
    return code_digests(
        [settings["plant"], *(e.partition("@")[0] for e in effect_entries(settings) if ":" in e)]
    )


def effect_entries(settings: Settings) -> list[str]:
    """``effects`` as a list of names.

    Raises:
        ConfigError: if it is anything else.
    """
    given = settings.get("effects", [])
    if not isinstance(given, list) or not all(isinstance(entry, str) for entry in given):
        raise ConfigError(f"effects is {given!r}: give a list of names, as in effects=[viscous,coulomb]")
    return given


def fit_settings(settings: Settings) -> FitSettings:
    """``estimator`` as ``FitSettings``.

    Raises:
        ConfigError: if a key or value is not allowed.
    """
    return settings.section("estimator", FitSettings)


def _ownable(plant: Plant, effects: list[Effect]) -> set[str]:
    """The names of all parameters that the plant could have with any of ``effects`` at any port."""
    names = {p.name for p in plant.parameters} | {
        f"{p.name}.epsilon" for p in plant.ports if p.kind == "effort"
    }
    for effect in effects:
        for port in plant.ports:
            if port.kind == effect.kind:
                names |= {f"{port.name}.{effect.id}.{p.name}" for p in effect.parameters}
    return names
