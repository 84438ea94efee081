"""``launcher=slurm``: what it asks of Slurm, and what it makes of Slurm's answers. No cluster is needed."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from hydra_plugins.hybridid_launcher import slurm
from pipelines.shared.storage import read_json

ROOT = Path(__file__).parents[2]

PROGRAMS = {
    # runs the first job of the array and not the second, which squeue says is cancelled
    "sbatch": """
cp "$1" asked.sh
(sleep 1
 export SLURM_JOB_ID=70 SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=0 SLURM_NTASKS=1 SLURM_JOB_NUM_NODES=1
 export SLURM_NODEID=0 SLURM_JOB_NODELIST=here SLURM_PROCID=0 SLURM_LOCALID=0
 sh "$1") >log 2>&1 &
echo Submitted batch job 7""",
    "srun": """
while [ "${1#-}" != "$1" ]; do
    case $1 in --unbuffered) shift ;; *) shift 2 ;; esac
done
exec "$@" """,
    "squeue": "printf 'JOBID|STATE|NODELIST\\n7_0|RUNNING|here\\n7_1|CANCELLED|here\\n'",
    "scancel": 'echo "$@" >>cancelled',
}


@pytest.fixture
def cluster(tmp_path, monkeypatch):
    """Programs that answer as Slurm's do."""
    folder = tmp_path / "programs"
    folder.mkdir()
    for name, text in PROGRAMS.items():
        path = folder / name
        path.write_text(f"#!/bin/sh\n{text.strip()}\n")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))


def test_a_lost_job_is_named_and_the_other_is_done(cluster, say, quick, monkeypatch):
    monkeypatch.setattr("submitit.core.core.Job._results_timeout_s", 0)
    ours = ("launcher=slurm", "hydra.launcher.partition=long", "hydra.launcher.setup=['export A=1']")
    said = say("fit", *quick, *ours, "-m", "out=all", "estimator.horizon=150,400")
    assert said.code == 1
    assert "Slurm job 7_1 is lost (cancelled)" in said.complaint
    assert "estimator.horizon=400" in said.err
    (done,) = Path("all").glob("*/fit/estimate.json")
    assert read_json(done)["settings"]["horizon"] == 150
    asked = Path("asked.sh").read_text()
    for line in ("--array=0-1%2", "--partition=long", "--cpus-per-task=1", "--mem=4GB", "--time=120"):
        assert f"#SBATCH {line}\n" in asked
    assert "export A=1" in asked
    assert not Path("cancelled").exists()


def test_an_interrupt_cancels_the_jobs(cluster, say, quick, monkeypatch):
    def interrupted(job):
        raise KeyboardInterrupt

    monkeypatch.setattr("submitit.core.core.Job.results", interrupted)
    with pytest.raises(KeyboardInterrupt):
        say("fit", *quick, "launcher=slurm", "-m", "out=all", "estimator.horizon=150,400")
    assert Path("cancelled").read_text().split() == ["7_0", "7_1"]


def test_states_of_jobs():
    said = "JOBID|STATE|NODELIST\n7_0|RUNNING|a\n7_1|COMPLETING|b\n7_2|OUT_OF_MEMORY|c\n9|FAILED|d\n"
    found = slurm.states(said, {"7_0", "7_1", "7_2", "7_3"})
    assert {job: row["State"] for job, row in found.items()} == {
        "7_0": "RUNNING", "7_1": "RUNNING", "7_2": "OUT_OF_MEMORY", "7_3": "GONE"
    }  # fmt: skip


def test_asks_the_queue_for_jobs_that_have_not_ended():
    queue = slurm.queue_of_slurm()
    assert queue._make_command() is None
    queue.register_job("7_0")
    assert queue._make_command()[0] == "squeue"
    assert not queue.is_done("7_0", mode="cache")
    queue._info_dict.update(queue.read_info(b"JOBID|STATE|NODELIST\n"))
    assert queue.is_done("7_0", mode="cache"), "a job that Slurm forgot is waited for without end"


def test_remembers_how_a_job_ended_when_slurm_has_forgotten_it(cluster):
    queue = slurm.queue_of_slurm()
    queue.register_job("7_0")
    queue.register_job("7_1")
    queue.update()
    assert queue.get_state("7_1", mode="cache") == "CANCELLED"
    queue._info_dict.update(queue.read_info(b"JOBID|STATE|NODELIST\n"))
    assert queue.get_state("7_1", mode="cache") == "CANCELLED"
    assert queue.get_state("7_0", mode="cache") == "GONE"


def test_without_slurm_it_says_so(say, quick, monkeypatch):
    monkeypatch.setenv("PATH", "/nowhere")
    said = say("fit", *quick, "-m", "launcher=slurm", "out=all", "estimator.horizon=150,400")
    assert said.code != 0
    assert "this machine has no Slurm" in said.complaint
    assert "launcher=joblib" in said.complaint


def test_its_keys_are_those_of_submitit(say):
    said = say("fit", "case=emps", "launcher=slurm", "--cfg", "hydra")
    assert said.code == 0
    assert "timeout_min: 120" in said.out
    wrong = say("fit", "case=emps", "launcher=slurm", "hydra.launcher.partitoin=long", "--cfg", "hydra")
    assert wrong.code == 2
