"""``hybridid sweep`` from the terminal: a job killed on purpose, the same command again, an early start."""

from __future__ import annotations

import importlib.util
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from hybridid_cli import hydra_app
from hybridid_cli.config_files import conf_folder
from pipelines.shared import pool

NETWORKS = (
    "residual=narx", "residual.orders.error=2", "residual.orders.gray=1", "residual.every=5",
    "residual.horizons=[1]", "residual.depth=1", "residual.width=4,6", "residual.seeds=0",
    "residual.epochs=3", "sweep.stack=1", "sweep.processes=1",
)  # fmt: skip


def workers(process: subprocess.Popen[str]) -> list[int]:
    """Children of multiprocessing's server from which they are forked."""
    (server,) = (
        pid for pid in _children(process.pid) if b"forkserver" in Path(f"/proc/{pid}/cmdline").read_bytes()
    )
    return _children(server)


def _children(pid: int) -> list[int]:
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="finds the workers in /proc")
def test_a_killed_job_is_named_and_the_same_command_completes_the_sweep(environment, quick, process):
    words = [sys.executable, "-m", "hybridid_cli", "sweep", *quick, *NETWORKS]
    with subprocess.Popen(words, env=environment, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        said = []
        for line in running.stderr:
            said.append(line)
            if "residual.width=4" in line and "begins" in line:
                (worker,) = workers(running)
                os.kill(worker, signal.SIGKILL)
        code = running.wait()
    assert code == 1, said
    assert "1 of 2 points have no result: residual.width=4" in said[-1]
    assert "killed by SIGKILL" in said[-1]
    (folder,) = Path("outputs/sweeps").iterdir()
    assert "SIGKILL" in (folder / "index.html").read_text()

    again = process("sweep", *quick, *NETWORKS)
    assert again.code == 0, again.err
    assert "2 points, 1 of them fresh, 1 to do on 1 core" in again.err
    assert "2 of 2 points have results, 1 of them from before" in again.out
    assert list(Path("outputs/sweeps").iterdir()) == [folder]
    assert folder.name.endswith("-simulated")


@pytest.mark.parametrize("wait", [0.0, 1.0])
def test_ctrl_c_while_the_workers_libraries_are_imported_is_one_line(environment, quick, wait):
    """Ctrl-C reaches all processes of a command, also the one that imports torch for the workers."""
    words = [sys.executable, "-m", "hybridid_cli", "sweep", *quick, *NETWORKS]
    with subprocess.Popen(
        words, env=environment, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as running:
        assert running.stderr is not None
        while not any(
            b"forkserver" in Path(f"/proc/{p}/cmdline").read_bytes() for p in _children(running.pid)
        ):
            time.sleep(0.05)
        time.sleep(wait)
        os.killpg(running.pid, signal.SIGINT)
        said = running.stderr.read()
        assert running.wait() == 130
    assert said.splitlines()[-1].startswith("hybridid: interrupted")
    assert "Traceback" not in said
    assert "KeyboardInterrupt" not in said


def test_one_word_for_each_mistake(say, quick):
    assert "'residual.widht'" in say("sweep", *quick, "residual=narx", "residual.widht=1,2").complaint
    said = say("sweep", *quick, "residual=narx", "residual.width=interval(1,2)")
    assert said.code == 2
    assert "range() or choice()" in said.complaint
    assert "has no values" in say("sweep", *quick, "estimator.horizon=range(1,0)").complaint
    said = say("sweep", *quick, "sweep.stack=0")
    assert said.code == 2
    assert "sweep.stack is 0" in said.complaint


def test_the_config_is_shown_without_a_sweep(say, quick):
    said = say("sweep", *quick, "--cfg", "job")
    assert said.code == 0
    assert "stack: null" in said.out


@pytest.fixture
def configs():
    """``configs(words)``: what a sweep of these words is over, as Hydra would compose it."""
    from hydra import initialize_config_dir
    from hydra.core.global_hydra import GlobalHydra
    from hydra.core.override_parser.overrides_parser import OverridesParser
    from hydra.types import RunMode

    from hybridid_cli.sweeper import Configs

    def found(*words: str):
        with initialize_config_dir(str(conf_folder()), version_base="1.3"):
            loader = GlobalHydra.instance().config_loader()
            config = loader.load_configuration("sweep", list(words), RunMode.MULTIRUN)
            parser = OverridesParser.create(config_loader=loader)
            return list(Configs(parser.parse_overrides(list(words)), parser, loader, config))

    return found


def test_groups_and_values_are_swept_in_all_combinations(configs):
    words = ("case=esea", "residual=narx_esea", "friction=linear,dahl", "residual.orders.error=range(1,4)")
    found = configs(*words)
    assert [(at["friction"], at["residual.orders.error"]) for _, at in found] == [
        (friction, order) for friction in ("linear", "dahl") for order in (1, 2, 3)
    ]
    for settings, at in found:
        assert settings.in_sweep
        assert settings["residual.orders.error"] == at["residual.orders.error"]
        assert settings["effects"] == [{"linear": "viscous@motor", "dahl": "dahl@motor"}[at["friction"]]]


def test_values_are_what_hydra_itself_makes_of_them(configs):
    """Set in a composed config or composed with it: the same."""
    swept = configs("case=emps", "effects=[viscous,coulomb],[viscous]", "parameters.M.lower=null,50")
    for value in ("[viscous,coulomb]", "[viscous]"):
        (alone, _), *_ = configs("case=emps", f"effects={value}")
        same = [
            s for s, at in swept if at["effects"] == alone["effects"] and at["parameters.M.lower"] is None
        ]
        assert [s["effects"] for s in same] == [alone["effects"]]
        assert same[0]["estimator"] == alone["estimator"]


@pytest.mark.parametrize(
    ("words", "loads"),
    [
        (["-m", "case=vehicle"], True),
        (["-m", "case=vehicle", "launcher=joblib"], False),
        (["-m", "case=vehicle", "hydra/launcher=slurm"], False),
        (["--cfg", "job", "case=vehicle"], False),
    ],
)
def test_what_workers_need_is_loaded_early_only_where_they_are_ours(monkeypatch, words, loads):
    loaded = []
    monkeypatch.setattr(pool, "load_early", lambda *modules: loaded.extend(modules))
    hydra_app._load_early(words)
    assert bool(loaded) is loads
    assert all(importlib.util.find_spec(module) for module in loaded)
