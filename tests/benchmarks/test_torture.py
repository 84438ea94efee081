"""The torture sees what it looks for: each fault is shown to it, and one command is really struck."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import sqlite3
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from benchmarks.torture import endurance, kills, secrets, stores, whole
from benchmarks.torture.__main__ import PARTS
from benchmarks.torture.bench import LOST, WRONG, Fault, Found, Part, conducted, known
from benchmarks.torture.command import Running, start
from benchmarks.torture.commands import Command
from benchmarks.torture.report import text
from pipelines.shared.storage import write_json, write_table

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")


@pytest.fixture
def tree(tmp_path):
    """A folder of whole results."""
    (tmp_path / "fit").mkdir()
    write_json(tmp_path / "fit" / "estimate.json", {"value": 1.0, "seconds": 3.0})
    write_table(tmp_path / "fit" / "series.parquet", {"t": np.arange(3.0)}, {})
    (tmp_path / "index.html").write_text("<html></html>\n")
    (tmp_path / "curve.svg").write_text("<svg/>\n")
    (tmp_path / "weights.npz").write_bytes(b"")
    np.savez(tmp_path / "weights.npz", a=np.ones(2))
    with sqlite3.connect(tmp_path / "some.db") as database:
        database.execute("create table one (x)")
    database.close()
    return tmp_path


def test_whole_files_are_whole(tree):
    assert list(whole.half_written(tree)) == []
    assert whole.left_behind(tree) == []


@pytest.mark.parametrize(
    "name", ["fit/estimate.json", "fit/series.parquet", "index.html", "curve.svg", "weights.npz", "some.db"]
)
def test_a_file_that_was_cut_off_is_seen(tree, name):
    content = (tree / name).read_bytes()
    (tree / name).write_bytes(content[: len(content) // 2])
    (said,) = whole.half_written(tree)
    assert said.startswith(name)


def test_a_file_without_its_name_is_no_result_but_is_seen_when_it_stays(tree):
    (tree / ".unfinished-x").mkdir()
    (tree / ".unfinished-x" / "estimate.json").write_text("{")
    assert list(whole.half_written(tree)) == []
    assert whole.left_behind(tree) == [".unfinished-x"]


def test_numbers_differ_by_results_and_not_by_time(tree):
    before = whole.numbers(tree)
    write_json(tree / "fit" / "estimate.json", {"value": 1.0, "seconds": 9.0})
    assert whole.numbers(tree) == before
    write_json(tree / "fit" / "estimate.json", {"value": 1.0 + 1e-15, "seconds": 9.0})
    assert {name for name, digest in whole.numbers(tree).items() if before[name] != digest} == {
        "fit/estimate.json"
    }


def test_how_results_were_come_by_is_no_result(tree):
    write_json(tree / "sweep.json", {"value": 1.0, "plan": {"fresh": []}})
    before = whole.numbers(tree)
    write_json(tree / "sweep.json", {"value": 1.0, "plan": {"fresh": ["width=4"]}})
    assert whole.numbers(tree) == before


def test_of_what_is_drawn_only_the_number_counts():
    one = whole.how_many({"MLflow: trial 2 c8a1": "c8a1", "MLflow: trial 3 77f0": "77f0", "tune.json": "a"})
    assert one == whole.how_many({"MLflow: trial 0 1c": "1c", "MLflow: trial 12 2d": "2d", "tune.json": "b"})
    assert one != whole.how_many({"MLflow: trial 0 1c": "1c", "tune.json": "b"})


@LINUX
def test_a_process_that_outlives_its_command_is_seen(tmp_path):
    """Also one that left the session."""
    stays = f"import subprocess, sys; subprocess.Popen(['sleep', '60'], start_new_session={True})"
    mark = {**os.environ, "HYBRIDID_TORTURE": "this test"}
    process = subprocess.Popen([sys.executable, "-c", stays], env=mark, start_new_session=True)
    process.wait()
    running = Running(process.pid, "this test", tmp_path / "out", tmp_path / "err", code=0)
    ((pid, said),) = running.left().items()
    assert "sleep" in said
    os.kill(pid, signal.SIGKILL)


@LINUX
def test_a_command_is_struck_when_it_heeds_signals(tmp_path):
    words = ("fit", "case=emps", "data=simulated", "mlflow.enabled=false")
    running = start(words, tmp_path, fresh=True, says=tmp_path / "said")
    assert running.ready(60)
    running.strike(signal.SIGTERM)
    assert running.waited(60)
    assert running.code == 143, running.complaint()
    assert running.complaint().startswith("hybridid: told to end (SIGTERM)")
    until = time.monotonic() + 20
    while running.left():
        assert time.monotonic() < until
        time.sleep(0.05)


def test_every_trial_is_unique_and_names_its_seed():
    found = [trial for part in PARTS for trial in part.trials(7)]
    assert len({trial.key for trial in found}) == len(found)
    assert all("seed 7" in trial.key or "read-only" in trial.key for trial in found)
    assert len(kills.trials(7)) >= 300
    assert {kill.signal for kill in kills.trials(7)} == set(kills.SIGNALS)
    assert [kill.drawn() for kill in kills.trials(7)] == [kill.drawn() for kill in kills.trials(7)]
    assert kills.trials(7)[0].drawn() != kills.trials(8)[0].drawn()


@dataclass
class Once:
    """A trial that breaks the first time."""

    key: str = "once"
    category: str = "kind"
    seed: int = 7
    tried: int = 0

    def carried_out(self, bench: Path) -> Found:
        self.tried += 1
        return Found("tried", (Fault(LOST, "a file"),) if self.tried == 1 else (), {"kills": 1.0})


def test_a_run_goes_on_where_it_stopped_and_tries_again_what_broke(tmp_path):
    file, trial = tmp_path / "results.jsonl", Once()
    (line,) = conducted("parts", [trial], file, any_code=False)
    assert line["faults"] == [{"kind": LOST, "what": "a file"}]
    with file.open("a") as out:
        out.write('{"key": "cut o')  # killed as it wrote
    list(conducted("parts", [trial], file, any_code=False))
    assert trial.tried == 2
    assert list(conducted("parts", [trial], file, any_code=False)) == []
    assert known(file, [trial])["once"]["faults"] == []
    assert known(file, [trial])["once"]["earlier"] == line["faults"]
    assert list(tmp_path.iterdir()) == [file], "what the trials used stays"


def test_a_trial_of_other_code_is_tried_again(tmp_path):
    file, trial = tmp_path / "results.jsonl", Once(tried=1)
    (line,) = conducted("parts", [trial], file, any_code=False)
    file.write_text(json.dumps({**line, "version": "other"}) + "\n")
    assert list(conducted("parts", [trial], file, any_code=True)) == []
    assert len(list(conducted("parts", [trial], file, any_code=False))) == 1


def test_the_page_says_what_was_run_and_names_what_broke():
    kill = Part(
        "kills", "Each is struck.", (LOST, WRONG), lambda seed: [Once(key) for key in "abcd"], {"kills": 300}
    )
    line = {
        "part": "kills", "category": "fit", "commit": "31eadfe", "date": "2026-11-23", "machine": "a machine",
        "faults": [], "counts": {"kills": 1.0}, "skipped": "", "said": "", "seconds": 30.0,
    }  # fmt: skip
    broke = {**line, "key": "kills: fit, SIGKILL", "faults": [{"kind": LOST, "what": "estimate.json"}] * 2}
    skipped = {**line, "key": "disk", "part": "disks", "counts": {}, "skipped": "only root may mount"}
    disk = Part("disks", "Disks fill up.", (LOST,), lambda seed: [Once()])
    never = Part("endurance", "Loops.", (LOST,), lambda seed: [Once()])
    mended = {**line, "key": "a", "earlier": [{"kind": WRONG, "what": "estimate.json"}]}
    there = {kill: {"a": mended, "b": broke}, disk: {"once": skipped}, never: {}}
    page = text(there, seed=20)
    assert "| kills | 2 of 4 | 31eadfe | 2026-11-23 | a machine | 1 |" in page
    assert "| endurance | not run |" in page
    assert "- 2 kills, at least 300 are asked" in page
    assert "|  | trials | lost | silent wrong | seconds |" in page
    assert "| fit | 2 | 1 | 0 | 60 |" in page
    assert "| lost | 1 |" in page
    assert "- kills: fit, SIGKILL: lost: estimate.json" in page
    assert "- disks: 1 trials: only root may mount" in page
    assert page.index("## What broke in an earlier run") < page.index("- a: silent wrong")
    assert "| secret found |" not in page
    assert "## Endurance" not in page


def test_a_loop_that_grows_is_told(tmp_path, monkeypatch):
    kept = []
    monkeypatch.setattr(endurance, "ROUNDS", {"fits": 20})
    monkeypatch.setattr(endurance, "_fit", lambda number: kept.append(np.ones(1_000_000)))
    found = endurance._apart("fits", tmp_path, 0)
    assert [fault.kind for fault in found.faults] == ["grows"]
    monkeypatch.setattr(endurance, "_fit", lambda number: None)
    assert endurance._apart("fits", tmp_path, 0).faults == ()
    assert multiprocessing.active_children() == []


def test_a_store_that_lacks_a_run_or_a_number_is_told(tmp_path):
    with sqlite3.connect(tmp_path / "mlflow.db") as database:
        database.executescript(
            "create table runs (run_uuid, status); create table tags (run_uuid, key, value);"
            "create table latest_metrics (run_uuid, key);"
            "insert into runs values ('a', 'FINISHED'); insert into tags values ('a', 'hybridid.key', '1');"
            "insert into latest_metrics values ('a', 'number.0');"
        )
    database.close()
    said = [fault.what for fault in stores._wrong(tmp_path, {"1", "2"})]
    assert said == ["no run 2", "run 1 is FINISHED with 1 of 5 numbers"]


FORKS = """
import atexit, os, sys
from pathlib import Path
from benchmarks.torture.bench import bench

with bench(Path(sys.argv[1])) as folder:
    if os.fork() == 0:
        atexit._run_exitfuncs()
        os._exit(0)
    os.wait()
    assert folder.is_dir()
assert not folder.exists()
"""


def test_a_command_that_ends_leaves_the_bench_that_it_was_forked_from(tmp_path):
    done = subprocess.run([sys.executable, "-c", FORKS, tmp_path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@LINUX
def test_a_secret_that_is_written_is_found(tmp_path, monkeypatch):
    """In a file, as it is or in a header, and in what the command said."""

    def writes(words, lab, more):
        said = Running(0, "", lab.parent / "out", lab.parent / "err", code=0)
        said.out.write_text(" ".join(words))
        said.err.write_text("")
        (lab / "headers.bin").write_bytes(secrets.spellings(more["MLFLOW_TRACKING_TOKEN"])[1])
        return said

    monkeypatch.setattr(secrets, "load", lambda: None)
    monkeypatch.setattr(secrets, "started", writes)
    found = secrets.Planted(Command("fit", ("fit", "case=emps")), seed=1).carried_out(tmp_path)
    assert sorted(fault.what for fault in found.faults) == [
        "that of MLFLOW_TRACKING_TOKEN in lab/headers.bin",
        "that of the address of a tracking server in out",
    ]
