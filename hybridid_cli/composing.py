"""The config of a command as Hydra composes it, without Hydra's application."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hydra import compose, initialize_config_dir
from omegaconf import DictConfig, OmegaConf, open_dict

from hybridid_cli.config_files import conf_folder
from pipelines.shared.config import Settings
from pipelines.shared.own_code import make_importable


def settings_of(words: Sequence[str], command: str = "fit", folders: Sequence[Path] = ()) -> Settings:
    """What ``hybridid COMMAND WORDS`` would run with; ``folders`` are those of ``--config-dir``.

    Raises:
        HydraException: if the words do not fit the config files.
        ConfigError: if a key or a value is not allowed.
    """
    own = tuple(folder.resolve() for folder in folders)
    make_importable(own)
    path = ",".join(f"file://{folder}" for folder in own)
    with initialize_config_dir(str(conf_folder()), version_base="1.3"):
        return composed([f"hydra.searchpath=[{path}]", *words], command, own)


def composed(words: Sequence[str], command: str, folders: tuple[Path, ...] = ()) -> Settings:
    """The same where Hydra is at work already, and knows the ``folders``."""
    config = compose(command, list(words), return_hydra_config=True)
    case = str(config.hydra.runtime.choices["case"])
    with open_dict(config):
        del config["hydra"]
    return Settings(case, plain_config(config), folders)


def plain_config(config: DictConfig) -> dict[str, Any]:
    """A config as plain containers, with what its values refer to in their place."""
    plain = OmegaConf.to_container(config, resolve=True, throw_on_missing=True)
    assert isinstance(plain, dict)
    return {str(key): value for key, value in plain.items()}
