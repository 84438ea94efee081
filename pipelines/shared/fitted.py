"""The files of a fitted model: ``load(tree)`` gives the model and estimate of ``fit``, ready to simulate."""

from __future__ import annotations

import functools
import operator
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hybridid.estimators.estimate import Estimate
from hybridid.model import Model
from hybridid.naming import listed
from hybridid.quality import Quality
from hybridid.quantities import quantity
from pipelines.shared.by_group import Grouping
from pipelines.shared.by_record import MARK
from pipelines.shared.config import Settings
from pipelines.shared.modelling import groupings_of, model_of
from pipelines.shared.own_code import importable, make_importable
from pipelines.shared.parameters import BY, parameters_of
from pipelines.shared.prepared import NamedUnit
from pipelines.shared.storage import read_as
from pipelines.shared.trust import admit, paths_in

ESTIMATE = "fit/estimate.json"
MODEL = "fit/model.json"
MAKES_A_MODEL = ("plant", "channels", "effects", "parameters")


@dataclass(frozen=True)
class Fit:
    """``model``, the gray box of a ``case`` with the terms ``effects``, fitted to ``records``.

    ``provenance`` is that of the records: "measured", "simulated" or both. ``quality`` is the verdict on it;
    where that does not trust the fit, the estimates have no standard errors.
    """

    case: str
    model: str
    records: tuple[str, ...]
    provenance: str
    effects: tuple[str, ...]
    quality: Quality
    estimate: Estimate = field(metadata={"inline": True})


def fit_of(tree: Path) -> Fit:
    """The fit of a run tree, from ``fit/estimate.json``."""
    return read_as(Fit, tree / ESTIMATE)


@dataclass(frozen=True)
class TermEquation:
    """An effect at a port: its name, equation and source."""

    name: str
    equation: str
    source: str


@dataclass(frozen=True)
class DescribedModel:
    """What rebuilds a model, and its equations for a reader.

    ``config`` holds the keys ``plant``, ``channels``, ``effects`` and ``parameters``; the user's own code
    lies in ``python_folders``. ``provenance`` is that of the records behind its effects and parameters.
    """

    case: str
    config: Mapping[str, Any]
    python_folders: tuple[Path, ...]
    states: tuple[NamedUnit, ...]
    inputs: tuple[NamedUnit, ...]
    outputs: tuple[NamedUnit, ...]
    terms: tuple[TermEquation, ...]
    provenance: str


def describe_model(settings: Settings, model: Model, provenance: str) -> DescribedModel:
    """The content of ``model.json`` for a ``model`` that ``settings`` configure."""
    return DescribedModel(
        case=settings.case,
        config={
            **{key: settings.get(key) for key in MAKES_A_MODEL},
            "parameters": _parameters(settings, model),
        },
        python_folders=tuple(dict.fromkeys(f.resolve() for f in (*settings.folders, *importable()))),
        states=NamedUnit.each(model.states),
        inputs=NamedUnit.each(model.inputs),
        outputs=NamedUnit.each(model.outputs),
        terms=tuple(TermEquation(t.name, t.effect.equation, t.effect.source) for t in model.terms),
        provenance=provenance,
    )


def _parameters(settings: Settings, model: Model) -> Mapping[str, Any] | None:
    """``parameters`` of the config, with a mark at those that the records give, and with the names of the
    groups at those that differ between groups of records."""
    given: Mapping[str, Any] | None = settings.get("parameters")
    if model.groups:
        given = parameters_of(settings)
        for one in groupings_of(settings, model):
            *path, last = one.parameter.split(".")
            node = functools.reduce(operator.getitem, path, given)
            node[last][BY] = one.setting
    return {**(given or {}), **{name: {MARK: True} for name in model.by_record}} if model.by_record else given


def load(tree: Path, folders: Sequence[Path] = ()) -> tuple[Model, Estimate]:
    """The fitted model of a run tree and its estimate; ``estimate.values`` are its parameters.

    ``folders`` are those of your own code, as ``--config-dir`` names them.

    Raises:
        FileNotFoundError: if the tree holds no fit.
        Untrusted: if its model needs code of a folder that you neither name nor trust.
        ConfigError: if the plant or an effect can no longer be imported.
    """
    make_importable(folders)
    described = read_as(DescribedModel, tree / MODEL)
    admit(f"{tree / MODEL}: it", paths_in(described.config), described.python_folders)
    return model_of(Settings(described.case, described.config)), fit_of(tree).estimate


def fitted_model(settings: Settings, tree: Path) -> tuple[Model, Estimate]:
    """The same for a stage: the model as ``settings`` configure it, whatever code the tree's files name."""
    return model_of(settings), fit_of(tree).estimate


def without_own(groups: Iterable[Grouping], record: str, estimate: Estimate) -> Iterator[str]:
    """Of each parameter of ``groups`` that has no value of its own in ``record``, what is taken, in words."""
    found = {one.parameter: one for one in estimate.differences}
    for one in groups:
        if not one.has(record):
            mean = quantity(found[one.parameter].mean, found[one.parameter].unit)
            yield (
                f"record {record} is not fitted, so {one.parameter} has no value of its own there: "
                f"the mean of {listed(one.names)} is taken, {mean}"
            )
