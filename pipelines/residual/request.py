"""The section ``residual`` of a config: which network, and how it is made."""

from __future__ import annotations

import abc
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Self

from hybridid.demand import Demand
from hybridid.estimators.estimate import Progress
from hybridid.hybrid import FittedHybrid, GrayBox
from hybridid.model import Model
from hybridid.plain import build
from hybridid.records.record import Record
from hybridid.settings.fit import FitSettings
from pipelines.shared.errors import ConfigError
from pipelines.shared.watch import Watcher


class Request(abc.ABC):
    """One kind of residual network, as configured."""

    @classmethod
    def of(cls, section: Mapping[str, Any]) -> Self:
        """The request that the section makes.

        Raises:
            ConfigError: if a key or a value is not allowed.
        """
        return build(cls, section, "residual", ConfigError)

    @abc.abstractmethod
    def check(self, model: Model) -> None:
        """Whether it suits the model.

        Raises:
            ConfigError: if it names an output, input or port that the model lacks.
        """

    @abc.abstractmethod
    def demand(self, model: Model, records: Sequence[Record], fitted: FitSettings) -> Demand:
        """What it needs beside ``model`` on ``records`` (none: at least), which was fitted as ``fitted``."""

    @abc.abstractmethod
    def make(self, gray: GrayBox, watcher: Watcher) -> FittedHybrid:
        """Fit the network to the error of the gray box on its records.

        Raises:
            ValueError: if it cannot be done.
        """


def reporter(watcher: Watcher) -> Callable[[Progress], None]:
    """Hands a fit's reports to the watcher."""
    return lambda report: watcher.progress(
        report.stage, f"{report.iteration} rounds, {report.cost:.4g}", report.fraction
    )
