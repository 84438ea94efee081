"""Hydra looks for sweepers in this package alone: here is that of ``hybridid sweep``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hydra.plugins.sweeper import Sweeper
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig


class HybrididSweeper(Sweeper):
    """Hands over to ``hybridid_cli.sweeper``, imported when it sweeps: every Hydra application loads this."""

    def __init__(self, params: Mapping[str, Any] | None = None, max_batch_size: int | None = None) -> None:
        self._first = [f"{key}={value}" for key, value in (params or {}).items()]

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        self._with = (hydra_context, task_function, config)

    def sweep(self, arguments: list[str]) -> None:
        from hybridid_cli.sweeper import sweep

        sweep([*self._first, *arguments], *self._with)
