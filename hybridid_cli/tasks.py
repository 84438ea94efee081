"""What Hydra runs for each command, in this process or in a launcher's."""

from __future__ import annotations

import copy
import functools
import signal
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from omegaconf import DictConfig

from hybridid.plain import build
from hybridid.settings import keys
from hybridid_cli import interrupt
from hybridid_cli.composing import composed, plain_config
from hybridid_cli.terminal import Terminal
from hybridid_cli.trusting import trusted_when_asked
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, Incomplete, NotConverged, WrongModel
from pipelines.shared.own_code import make_importable
from pipelines.shared.secrets import mask_streams
from pipelines.shared.sections.stages import ReproduceKeys
from pipelines.shared.stage import Outcome
from pipelines.shared.trust import Untrusted


def settings_of(cfg: DictConfig) -> Settings:
    """The composed config as plain settings; the user's own folders become importable."""
    hydra = HydraConfig.get()
    return settings_from(cfg, hydra, hydra.mode == RunMode.MULTIRUN)


def own_folders(hydra: Any) -> tuple[Path, ...]:
    """The user's own folders, which ``--config-dir`` names."""
    sources = hydra.runtime.config_sources
    return tuple(Path(s.path) for s in sources if s.schema == "file" and s.provider != "main")


def settings_from(cfg: DictConfig, hydra: Any, in_sweep: bool) -> Settings:
    """The same of a config whose part ``hydra`` is given apart."""
    case = hydra.runtime.choices.get("case")
    if not case:
        raise ConfigError("no case: give case=NAME; hybridid cases lists them")
    folders = own_folders(hydra)
    make_importable(folders)
    plain = plain_config(cfg)
    if plain.get("model") is not None:
        plain = with_typed_parameters(_taken_up(plain), plain, hydra.overrides.task)
    words = () if in_sweep else tuple(hydra.overrides.task)
    return Settings(case, plain, folders, in_sweep, words)


def _taken_up(config: dict[str, Any]) -> dict[str, Any]:
    """``config`` with the model of its ``model.json``; on a terminal the user may trust the code it names."""
    from pipelines.shared.augmented import taken_up

    try:
        return taken_up(config)
    except Untrusted as asking:
        if not trusted_when_asked(asking):
            raise
    return taken_up(config)


def with_typed_parameters(
    taken_up: dict[str, Any], composed: Mapping[str, Any], words: Sequence[str]
) -> dict[str, Any]:
    """The config ``taken_up`` from a model file, with the parameters that the ``words`` of the command give,
    as they were ``composed``.

    Raises:
        ConfigError: if the words give a plant, channels or effects: those are the file's.
    """
    from pipelines.shared.fitted import MAKES_A_MODEL

    parameters = copy.deepcopy(taken_up["parameters"] or {})
    for word in (one for one in words if not one.startswith("~")):
        root, *path = word.lstrip("+").partition("=")[0].split(".")
        if root in MAKES_A_MODEL and root != "parameters":
            raise ConfigError(f"model={taken_up['model']} brings its own {root}: leave out {word}, or model=")
        if root == "parameters" and path:
            value, place = composed["parameters"], parameters
            for key in path[:-1]:
                if not isinstance(place.get(key), dict):
                    place[key] = {}
                value, place = value[key], place[key]
            place[path[-1]] = value[path[-1]]
    return {**taken_up, "parameters": parameters}


class Unfinished(BaseException):
    """Carries a command's exception through Hydra, which would otherwise print a message of its own."""

    def __init__(self, cause: Exception) -> None:
        super().__init__(str(cause))
        self.cause = cause


def task_of(command: str) -> Callable[[DictConfig], None]:
    """What Hydra is to run for a command."""
    own = {"sweep": sweep_job, "fetch": fetch, "log": log, "tune": tune, "ui": ui, "reproduce": reproduce}
    return own.get(command, stages)


def _raises_past_hydra(task: Callable[[DictConfig], None]) -> Callable[[DictConfig], None]:
    """``task`` whose exceptions pass through Hydra unprinted. In a sweep Hydra keeps them."""

    @functools.wraps(task)
    def run(cfg: DictConfig) -> None:
        mask_streams()  # a launcher's process did not begin with main
        try:
            task(cfg)
        except Exception as error:
            if HydraConfig.get().mode == RunMode.MULTIRUN:
                raise
            raise Unfinished(error) from error

    return run


@_raises_past_hydra
def stages(cfg: DictConfig) -> None:
    """Bring the stages of a command up to date, show what they found, and log the run."""
    from hybridid_cli.results import summary
    from pipelines.runner import run_stages
    from pipelines.shared.sources import sources_of
    from pipelines.tracking.runs import tracked

    settings = settings_of(cfg)
    hydra = HydraConfig.get()
    command = str(hydra.job.config_name)
    label = f"#{hydra.job.num} " if settings.in_sweep else ""
    label += "[simulated] " if sources_of(settings).simulated else ""
    with Terminal(label, bar=not settings.in_sweep) as terminal, tracked(settings, command, terminal) as run:
        try:
            outcome = run_stages(settings, command, terminal)
        except Exception:
            interrupt.check()
            raise
        terminal.show(summary(outcome, command))
        run.finish(outcome)
    if command != "trace" and not settings.in_sweep:
        _raise_what_is_wrong(outcome)


def _raise_what_is_wrong(outcome: Outcome) -> None:
    """After all is written and shown: what the exit code is to say of the fit. A trace judges by itself, and
    a sweep goes on."""
    if "fit" not in outcome.stages:
        return
    from hybridid.quality.verdict import WRONG
    from pipelines.shared.fitted import fit_of

    quality = fit_of(outcome.tree).quality
    reasons = "; ".join([f.said for f in quality.findings if f.kind in WRONG]) or quality.said
    if quality.verdict == "not_converged":
        raise NotConverged(f"the fit has not converged; its results are in {outcome.tree}")
    if quality.verdict == "wrong":
        raise WrongModel(f"{reasons}; the results are in {outcome.tree}")


@_raises_past_hydra
def sweep_job(cfg: DictConfig) -> None:
    """One job of a sweep, in the process that a launcher started for it."""
    from hybridid_cli.launching import job

    settings = settings_of(cfg)
    with Terminal(f"#{HydraConfig.get().job.num} ", bar=False) as terminal:
        job(Path(str(settings["sweep.job"])), settings, terminal)


@_raises_past_hydra
def reproduce(cfg: DictConfig) -> None:
    """Run the thesis' experiments and write its tables beside ours."""
    from pipelines.reproduce import reproduce as run

    own = ("experiments=", "processes=", "experiment=", "case=")
    words = [word for word in HydraConfig.get().overrides.task if not word.lstrip("+~").startswith(own)]
    config = plain_config(cfg)
    asked = build(ReproduceKeys, {key: config[key] for key in keys(ReproduceKeys)}, "", ConfigError)
    experiments = {name: composed([f"experiment={name}", *words], "run") for name in asked.experiments}
    with Terminal() as terminal:
        page = run(experiments, Path(str(cfg.paths.outputs)), terminal, asked.processes)
        terminal.show(f"page: {page}")


@_raises_past_hydra
def fetch(cfg: DictConfig) -> None:
    """Download the records of a case."""
    from pipelines.fetching import fetch_case

    settings = settings_of(cfg)
    with Terminal() as terminal:
        for path in fetch_case(settings, terminal):
            terminal.show(str(path))


@_raises_past_hydra
def tune(cfg: DictConfig) -> None:
    """Search for a network adaptively."""
    from hybridid_cli.tune_results import shortfall, tune_results
    from pipelines.tune.conduct import tune as run

    settings = settings_of(cfg)
    with Terminal() as terminal:
        found = run(settings, terminal)
        terminal.show(tune_results(found))
        if missing := shortfall(found):
            raise Incomplete(missing)


@_raises_past_hydra
def log(cfg: DictConfig) -> None:
    """Send the runs that wait to MLflow."""
    from pipelines.tracking.abandoned import end_abandoned
    from pipelines.tracking.waiting import folder, send_waiting

    settings = settings_of(cfg)
    left = []
    with Terminal() as terminal:
        for attempt in send_waiting(settings, terminal):
            said = f"{attempt.note.name} of {attempt.note.experiment}"
            if attempt.trouble:
                left.append(f"{said} to {attempt.uri}: {attempt.trouble}")
            else:
                terminal.show(f"sent {said} to {attempt.uri}")
        if left:
            raise Incomplete(f"{len(left)} runs still wait in {folder(settings)}; the first is {left[0]}")
        terminal.show(f"no run waits in {folder(settings)}")
        if trouble := end_abandoned(settings):
            raise Incomplete(f"runs of killed commands are still RUNNING in MLflow: {trouble}")


@_raises_past_hydra
def ui(cfg: DictConfig) -> None:
    """Serve MLflow's page on 127.0.0.1 until interrupted."""
    from pipelines.tracking.serving import serve

    settings = settings_of(cfg)
    with Terminal() as terminal:
        try:
            serve(settings, terminal)
        except KeyboardInterrupt:
            if (asked := interrupt.last()).signal != signal.SIGINT:  # Ctrl-C is the way to end it
                raise asked from None
