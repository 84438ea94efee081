"""``hybridid sweep``: overrides of several values each become points, and a launcher does the jobs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hydra.core.config_loader import ConfigLoader
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override, RangeSweep
from hydra.core.plugins import Plugins
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig, OmegaConf, open_dict, read_write

from hybridid.plain import build
from hybridid_cli.file_globs import with_files
from hybridid_cli.fleet_results import fleet_summary
from hybridid_cli.launching import runner_of
from hybridid_cli.sweep_results import failed, summary
from hybridid_cli.tasks import own_folders, settings_from
from hybridid_cli.terminal import Terminal
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, Incomplete
from pipelines.shared.limits import check_points, check_processes
from pipelines.shared.secrets import masked
from pipelines.shared.sections.searches import SweepSection
from pipelines.shared.sections.stages import LimitsSection
from pipelines.shared.sources import roots_of
from pipelines.shared.tree import locked
from pipelines.sweep.conduct import Sweep, SweepOutcome, conduct, folder_of
from pipelines.sweep.fleet import write_fleet
from pipelines.sweep.log import common, in_one_experiment
from pipelines.sweep.point import Point, expanded
from pipelines.sweep.report import write_report
from pipelines.tracking.parent_run import parent_run

_NOT_A_MODEL = ("launcher", "sweep", "hydra", "mlflow", "force", "out")
"""Config keys and groups that say how, not what."""


def sweep(words: Sequence[str], context: HydraContext, task: TaskFunction, config: DictConfig) -> None:
    """Do what is missing of the sweep that ``words`` ask for, and report on all of it.

    ``task`` is what a launcher has to run for each job.

    Raises:
        ConfigError: if nothing can be carried out as asked.
        Incomplete: if points have no result; names them.
    """
    parser = OverridesParser.create(config_loader=context.config_loader)
    roots = roots_of(config.paths.get("data"), own_folders(config.hydra))
    overrides = parser.parse_overrides(with_files(words, roots))
    with Terminal() as terminal:
        points = expanded(list(Configs(overrides, parser, context.config_loader, config)))
        settings = points[0].settings
        request = settings.section("sweep", SweepSection)
        check_processes(request.processes, "sweep.processes", settings)
        name = _name(points, config)
        points = in_one_experiment(points, name)
        shared = tuple(masked(o.input_line) for o in overrides if not o.is_sweep_override() and _is_model(o))
        asked = Sweep(name, tuple(map(masked, words)), shared, tuple(points), folder_of(name, points))
        plain = [word for o in overrides if not o.is_sweep_override() for word in _words(o)]
        launcher = _launcher(asked.folder, context, task, config)
        added = frozenset(_key(o) for o in overrides if o.is_add())
        runner = runner_of(launcher, plain, asked.folder, request.processes, added)
        logged = parent_run(common(points), name, asked.key, terminal)
        with locked(asked.folder, terminal.say), logged as parent:
            swept = conduct(asked, runner, request, parent, terminal)
            said, files = _reported(swept)
            numbers = {"points": len(points), "points.failed": len(swept.failures), "seconds": swept.seconds}
            parent.close(bool(swept.failures), numbers, [asked.folder / file for file in files])
        terminal.show(said)
    if swept.failures:
        raise Incomplete(failed(swept))


def _reported(swept: SweepOutcome) -> tuple[str, tuple[str, ...]]:
    """Write the files of a sweep, or of a fleet of traces; what the terminal shows, and the files' names."""
    if swept.sweep.points[0].is_traced:
        return fleet_summary(swept, write_fleet(swept)), ("index.html", "fleet.csv", "fleet.json")
    return summary(swept, write_report(swept)), ("index.html", "networks.csv", "sweep.json")


@dataclass(frozen=True)
class Configs:
    """The config of each combination of swept values, with those values by key.

    Hydra composes once for each choice of groups; plain values are set in what it made, as it would have
    done itself, for to compose takes a tenth of a second.
    """

    overrides: Sequence[Override]
    parser: OverridesParser
    loader: ConfigLoader
    config: DictConfig

    def __iter__(self) -> Iterator[tuple[Settings, Mapping[str, Any]]]:
        swept = [o for o in self.overrides if o.is_sweep_override()]
        for override in swept:
            if not override.is_discrete_sweep():
                given = override.input_line
                raise ConfigError(f"{given}: an interval has no points; give range() or choice()")
            if not _count(override):
                raise ConfigError(f"{override.input_line}: it has no values, so there is nothing to sweep")
        check_points(math.prod(map(_count, swept)), build(LimitsSection, self._limits, "limits", ConfigError))
        groups = [o for o in swept if self.loader.get_group_options(o.key_or_group)]
        values = [o for o in swept if o not in groups]
        plain = [word for o in self.overrides if o not in swept for word in _words(o)]
        first = [_words(o)[0] for o in values]
        for chosen in itertools.product(*map(_words, groups)):
            composed = self.loader.load_sweep_config(self.config, [*plain, *chosen, *first])
            options = {_key(o): word.partition("=")[2] for o, word in zip(groups, chosen, strict=True)}
            for combination in itertools.product(*map(_words, values)):
                yield self._with(composed, dict(zip(map(_key, values), combination, strict=True)), options)

    @property
    def _limits(self) -> Any:
        return OmegaConf.to_container(self.config.limits, resolve=True)

    def _with(
        self, composed: DictConfig, words: Mapping[str, str], options: Mapping[str, str]
    ) -> tuple[Settings, Mapping[str, Any]]:
        config, hydra = deepcopy(composed), composed.hydra
        values = {key: self.parser.parse_override(word).value() for key, word in words.items()}
        with open_dict(config), read_write(config):
            del config["hydra"]
            for key, value in values.items():
                OmegaConf.update(config, key, value, merge=True)
        return settings_from(config, hydra, in_sweep=True), {**options, **values}


def _launcher(folder: Path, context: HydraContext, task: TaskFunction, config: DictConfig) -> Any:
    """Hydra's launcher; what it writes goes below the sweep's folder."""
    with open_dict(config), read_write(config):
        config.hydra.sweep.dir = str(folder / "jobs")
    return Plugins.instance().instantiate_launcher(hydra_context=context, task_function=task, config=config)


def _name(points: Sequence[Point], config: DictConfig) -> str:
    """Of the experiment, else of the cases."""
    cases = dict.fromkeys(point.settings.case for point in points)
    return str(config.hydra.runtime.choices.get("experiment") or "-".join(cases))


def _is_model(override: Override) -> bool:
    return _key(override).partition(".")[0].partition("/")[0] not in _NOT_A_MODEL


def _key(override: Override) -> str:
    """The key or group, without ``+`` and the package."""
    return str(override.key_or_group)


def _count(override: Override) -> int:
    """How many values a swept override has; those of a range are not written out for it."""
    given = override.value()
    if isinstance(given, RangeSweep):
        assert given.start is not None
        assert given.stop is not None
        return max(0, math.ceil((given.stop - given.start) / given.step)) if given.step else 0
    return len(_words(override))


def _words(override: Override) -> list[str]:
    """The override as one word, or of a swept one a word for each value."""
    if not override.is_sweep_override():
        return [str(override.input_line)]
    key = override.get_key_element()
    return [f"{key}={value}" for value in override.sweep_string_iterator()]
