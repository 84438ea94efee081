"""Models as files: ``model=.../trace/model.json`` replaces plant, effects and parameters of a config."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from hybridid.advice.unequal import as_settings as noise_as_settings
from hybridid.declarations import Parameter
from hybridid.effects.library import EFFECTS
from hybridid.estimators import Estimate
from hybridid.model import Term
from hybridid.simulation.chosen import EXPLICIT
from hybridid.trace.cautions.doubted import REVISE
from hybridid.trace.cautions.horizon_advice import PARTS_OF_ALL
from hybridid.trace.entries import Width
from hybridid.trace.noise_floor.input_noise import NoiseLevel
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import MAKES_A_MODEL, DescribedModel
from pipelines.shared.modelling import effect_entries
from pipelines.shared.parameters import BY, parameters_of
from pipelines.shared.sections.stages import PathsSection
from pipelines.shared.storage import read_as
from pipelines.shared.trust import admit, paths_in

OF_A_RUN = (
    "archive", "controller", "estimator", "fit", "limits", "preprocess", "records", "rig", "signals",
    "validate",
)  # fmt: skip
"""Roots of the keys that a run with another model needs as they were typed."""
OF_A_TRACE = (*OF_A_RUN, *MAKES_A_MODEL, "model", "trace")
"""The same of another trace."""
NOTHING = 1e-6
"""Share of a parameter's scale below which its value counts as zero."""


def taken_up(config: Mapping[str, Any]) -> dict[str, Any]:
    """``config`` with its model (``MAKES_A_MODEL``) from the file that its key ``model`` names, if any.

    Raises:
        Untrusted: if the file names code of a folder that the user neither names nor trusts.
        ConfigError: if there is no such file, or it holds no model.
    """
    if config.get("model") is None:
        return dict(config)
    path = Path(str(config["model"]))
    if path.is_dir():
        path = path / "model.json"
    try:
        described = read_as(DescribedModel, path)
        saved = {"channels": None, **described.config}  # an older file has no channels
        given = {key: saved[key] for key in MAKES_A_MODEL}
    except FileNotFoundError as error:
        raise ConfigError(f"model is {path}: no such file; fit and trace write one, model.json") from error
    except (OSError, ValueError, KeyError) as error:
        raise ConfigError(f"model is {path}: no model.json as fit and trace write it") from error
    admit(f"model is {path}: it", paths_in(given), described.python_folders, paths_in(config))
    return {**config, **given}


def augmented(
    settings: Settings,
    terms: Sequence[Term],
    paths: Mapping[str, str],
    estimate: Estimate,
    widths: Sequence[Width] = (),
    free: Sequence[Parameter] = (),
) -> Settings:
    """The settings with ``terms`` among their effects and the values of ``estimate`` as first guesses, also
    of the ``free`` parameters: from other guesses a fit may end in another valley.

    ``paths`` gives the import path of each of the user's own effects, by id. A constant of a term that is not
    estimated (the side of an end stop) keeps its value. ``widths`` are smoothings that a trace made narrower.
    """
    names = [f"{paths.get(term.effect.id, term.effect.id)}@{term.port}" for term in terms]
    parameters = parameters_of(settings)
    values, library = estimate.values, {effect.id: effect for effect in EFFECTS}
    for term in terms:
        own = parameters.setdefault(term.port, {}).setdefault(term.effect.id, {})
        for p in term.effect.parameters:
            setting = "fixed" if p.fixed else "guess"
            before = {key: value for key, value in (own.get(p.name) or {}).items() if key != BY}
            if p not in library.get(term.effect.id, term.effect).parameters and not p.fixed:
                before["upper"] = p.upper  # a time at the sampling of the records
            own[p.name] = {**before, setting: values[f"{term.name}.{p.name}"]}
    added = {f"{term.name}.{p.name}" for term in terms for p in term.effect.parameters}
    for parameter in free:
        if parameter.name in values.keys() - added:
            _guessed(parameters, parameter, values[parameter.name])
    for width in widths:
        port, name = width.name.split(".")
        parameters.setdefault(port, {}).setdefault(name, {})["guess"] = width.used
    config = {**settings.config, "effects": [*effect_entries(settings), *names], "parameters": parameters}
    return replace(settings, config=config)


def _guessed(parameters: dict[str, Any], parameter: Parameter, value: float) -> None:
    """Write ``value`` into nested ``parameters`` as the guess of a parameter. What is nothing beside its
    scale is zero, which keeps that scale."""
    *path, name = parameter.name.split(".")
    for key in path:
        parameters = parameters.setdefault(key, {})
    nothing = abs(value) < NOTHING * parameter.scale and parameter.lower <= 0.0 <= parameter.upper
    parameters[name] = {**(parameters.get(name) or {}), "guess": 0.0 if nothing else value}


def as_settings(widths: Sequence[Width]) -> list[str]:
    """``widths`` as words of a command: ``parameters.carriage.epsilon.guess=8.5e-05``."""
    return [f"parameters.{width.name}.guess={width.used!r}" for width in widths]


def by_recording(settings: Settings, own_values: Sequence[str]) -> tuple[str, ...]:
    """A command that traces with what differs between the recordings, if anything does: the settings
    ``own_values``."""
    return (_command("trace", settings, OF_A_TRACE, *own_values),) if own_values else ()


def further_traces(settings: Settings, cautions: Sequence[str]) -> tuple[str, ...]:
    """Commands that trace with what the ``cautions`` of a trace advise to ask: parts of every record, and
    whether the declared effects are right."""
    asked = [words for words in (PARTS_OF_ALL, REVISE) if any(words in caution for caution in cautions)]
    return tuple(_command("trace", settings, OF_A_TRACE, *words.split()) for words in asked)


def commands(
    settings: Settings,
    model: Path,
    samples: int,
    widths: Sequence[Width] = (),
    weights: Mapping[str, NoiseLevel] | None = None,
    steps: int | None = None,
    seconds: float | None = None,
) -> tuple[str, ...]:
    """Two commands that fit the augmented model: one names its file, and begins where the trace ended; the
    other its effects alone, with the ``widths`` of sign(v) that a trace made narrower. In both the outputs
    count by the ``weights`` of the trace, and RK4 takes so many ``steps`` a sample (None: as many as a fit
    chooses). The errors are those over horizons of so many ``seconds``, as in the trace."""
    counted = noise_as_settings({name: level.value for name, level in (weights or {}).items()})
    over = [f"estimator.horizon={samples}"]
    if seconds not in (None, settings["validate.horizon"]):
        over.append(f"validate.horizon={seconds:.6g}")
    solved = [f"estimator.integrator={EXPLICIT}", f"estimator.substeps={steps}"] if steps else []
    by_file = [*counted, f"model={model}", *over, "estimator.start=guess", *solved]
    effects = f"effects=[{','.join(effect_entries(settings))}]"
    by_effects = [*counted, effects, *as_settings(widths), *over, *solved]
    return (
        _command("run", settings, OF_A_RUN, *by_file),
        _command("run", settings, (*OF_A_RUN, *MAKES_A_MODEL), *by_effects),
    )


def _command(name: str, settings: Settings, roots: Sequence[str], *own: str) -> str:
    """A command with its ``own`` words, and with those that the user typed whose keys begin with one of
    ``roots``. Results and runs go where those of the user's command go."""
    taken = {_key(word) for word in own}
    typed = [w for w in settings.words if _key(w).split(".")[0] in roots and _key(w) not in taken]
    words = " ".join(map(shlex.quote, (*typed, *own)))
    return f"hybridid {name} case={settings.case}{_folders(settings)}{_elsewhere(settings)} {words}"


def _key(word: str) -> str:
    return word.lstrip("+~").partition("=")[0]


def _folders(settings: Settings) -> str:
    """The user's own folders of configs, in words of a command."""
    return "".join(f" --config-dir {shlex.quote(str(folder))}" for folder in settings.folders)


def _elsewhere(settings: Settings) -> str:
    """Where results are written and runs are logged, in words of a command, as far as the defaults differ."""
    outputs, logged = settings.paths.outputs, settings.mlflow.enabled
    said = "" if outputs == PathsSection().outputs else f" {shlex.quote(f'paths.outputs={outputs}')}"
    return said if logged else f"{said} mlflow.enabled=false"
