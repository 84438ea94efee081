"""What Hydra does around several runs of a command (``-m``)."""

from __future__ import annotations

from typing import Any

from hydra.experimental.callback import Callback
from omegaconf import DictConfig, OmegaConf, open_dict, read_write

from hybridid_cli.joblib_processes import let_joblib_watch
from pipelines.shared.secrets import moved_to_environment


class NoPasswordInFiles(Callback):
    """Takes the password out of the config before Hydra writes it to ``multirun.yaml``."""

    def on_multirun_start(self, config: DictConfig, **rest: Any) -> None:
        """Called with the composed config, which Hydra then writes and hands to its sweeper."""
        given = OmegaConf.to_container(config.mlflow, resolve=False)
        clean = moved_to_environment({"mlflow": given})["mlflow"]
        with read_write(config), open_dict(config):
            config.mlflow.tracking_uri = clean["tracking_uri"]


class JoblibEndsWithItsCommand(Callback):
    """Lets the processes of joblib watch the command, however it was told to run several times: by ``-m``,
    or by ``hydra.mode=MULTIRUN``."""

    def on_multirun_start(self, config: DictConfig, **rest: Any) -> None:
        """Called before Hydra makes the launcher."""
        if "joblib" in str(config.hydra.launcher.get("_target_", "")).lower():
            let_joblib_watch()
