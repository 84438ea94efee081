"""Where a run lies, and that two processes do not meet in it."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from pipelines.runner import run_stages
from pipelines.shared.config import digest
from pipelines.shared.errors import ConfigError
from pipelines.shared.tree import locked, point_latest, replacing, tree_of, write_bytes, write_text


def test_tree_is_named_by_the_modelling_config(settings):
    plain = settings()
    root = tree_of(plain, simulated=False)
    assert root == Path("outputs/short") / digest(plain)
    assert len(root.name) == 8
    assert int(root.name, 16) >= 0
    for other in ({"validate.horizon": 5.0}, {"mlflow.enabled": False}, {"paths.data": "elsewhere"}):
        assert tree_of(settings(other), False) == root
    for other in (
        {"effects": ["viscous"]},
        {"estimator.horizon": 20},
        {"parameters.M.guess": 90.0},
        {"fit.records": ["validation"]},
        {"preprocess.steps": [{"step": "crop", "stop": 1.0}]},
        {"records.first.files": "other.csv"},
    ):
        assert tree_of(settings(other), False) != root, other


def test_simulated_results_never_take_the_place_of_measured_ones(settings):
    assert tree_of(settings(), True).name == f"{digest(settings())}-simulated"


def test_out_is_the_tree_itself_and_in_a_sweep_its_parent(settings):
    changed = settings({"out": "here"})
    assert tree_of(changed, False) == Path("here")
    swept = settings({"out": "here"}, in_sweep=True)
    assert tree_of(swept, False) == Path("here") / digest(swept)


def test_latest_leads_to_the_last_run(settings, heard, data):
    first = run_stages(settings(), "preprocess", heard).tree
    second = run_stages(settings({"effects": ["viscous"]}), "preprocess", heard).tree
    assert first != second
    assert (second.parent / "latest").resolve() == second.resolve()
    run_stages(settings(), "preprocess", heard)
    assert (second.parent / "latest").resolve() == first.resolve()


def test_latest_that_is_somebodys_folder_stays(tmp_path):
    (tmp_path / "latest").mkdir()
    (tmp_path / "run").mkdir()
    point_latest(tmp_path / "run")
    assert not (tmp_path / "latest").is_symlink()


def test_out_that_is_a_file(settings, heard, data):
    Path("here").write_text("mine")
    with pytest.raises(ConfigError, match="this is a file; give a folder"):
        run_stages(settings({"out": "here"}), "preprocess", heard)
    assert Path("here").read_text() == "mine"


def test_config_is_kept_in_the_tree(settings, heard, data):
    tree = run_stages(settings({"estimator.horizon": 77}), "preprocess", heard).tree
    assert "horizon: 77" in (tree / "config.yaml").read_text()


def test_folder_appears_whole_or_not_at_all(tmp_path):
    folder = tmp_path / "fit"
    with replacing(folder) as new:
        (new / "a").write_text("1")
        assert not folder.exists()
    assert (folder / "a").read_text() == "1"
    with pytest.raises(KeyboardInterrupt):
        begin_and_be_interrupted(folder)
    assert (folder / "a").read_text() == "1"
    assert [p.name for p in tmp_path.iterdir()] == ["fit"]


def begin_and_be_interrupted(folder):
    with replacing(folder) as new:
        (new / "a").write_text("2")
        raise KeyboardInterrupt


def test_file_is_whole_at_every_moment(tmp_path):
    write_text(tmp_path / "x", "old")
    with pytest.raises(TypeError):
        write_bytes(tmp_path / "x", 3)  # type: ignore[arg-type]
    assert (tmp_path / "x").read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["x"]


def test_second_process_waits_for_the_tree(tmp_path):
    said: list[str] = []
    entered = threading.Event()

    def enter() -> None:
        with locked(tmp_path, said.append):
            entered.set()

    with locked(tmp_path, said.append):
        other = threading.Thread(target=enter)
        other.start()
        assert not entered.wait(0.6)
    other.join(10)
    assert entered.is_set()
    assert said == [f"waiting: another hybridid process is writing in {tmp_path}"]
