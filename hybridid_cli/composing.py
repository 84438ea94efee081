"""The config of a command as Hydra composes it, without Hydra's application."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf, open_dict

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
        composed = compose(command, [f"hydra.searchpath=[{path}]", *words], return_hydra_config=True)
    case = str(composed.hydra.runtime.choices["case"])
    with open_dict(composed):
        del composed["hydra"]
    config = OmegaConf.to_container(composed, resolve=True)
    assert isinstance(config, dict)
    return Settings(case, {str(key): value for key, value in config.items()}, own)
