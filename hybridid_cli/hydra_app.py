"""Hands a command to Hydra: overrides, sweeps, launchers, ``--cfg`` and ``--config-dir`` are Hydra's."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from hybridid_cli import interrupt
from hybridid_cli.config_files import conf_folder
from hybridid_cli.main import complain, wants_traceback
from hybridid_cli.words import prepared


def run(command: str, words: Sequence[str]) -> int:
    """Carry out a command that has a primary config; returns the exit code."""
    if "--debug" in words:
        os.environ["HYBRIDID_DEBUG"] = "1"
    ready = prepared(command, words)
    traceback = wants_traceback()
    import hydra

    from hybridid_cli.explain import explained
    from hybridid_cli.tasks import Unfinished, task_of

    os.environ["HYDRA_FULL_ERROR"] = "1"  # exceptions come here whole; what the user sees is said below
    sys.argv = [f"hybridid {command}", *ready]
    application = hydra.main(config_path=str(conf_folder()), config_name=command, version_base="1.3")
    try:
        application(task_of(command))()
    except (Exception, Unfinished) as raised:
        interrupt.check()
        if traceback:
            raise
        error = raised.cause if isinstance(raised, Unfinished) else raised
        message, code = explained(error, command, words)
        return complain(message, code)
    return 0
