"""``launcher=slurm``: Submitit's launcher, but a job that is lost is named while the others go on.

Submitit's own gives up at the first lost job and leaves the others to themselves, and asks ``sacct``, which a
cluster without an accounting database does not have.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hydra.core.singleton import Singleton
from hydra.core.utils import JobReturn, JobStatus, filter_overrides
from hydra_plugins.hydra_submitit_launcher import submitit_launcher

from pipelines.shared.errors import ConfigError, LostJob

if TYPE_CHECKING:  # Hydra looks for plugins at every start: it must stay light
    from submitit import Job

log = logging.getLogger(__name__)

_OF_EVERY_EXECUTOR = (
    "timeout_min", "cpus_per_task", "gpus_per_node", "tasks_per_node", "mem_gb", "nodes", "name",
    "stderr_to_stdout",
)  # fmt: skip
_OF_THE_LAUNCHER = ("submitit_folder", "max_num_timeout")

_SECONDS_BETWEEN_LOOKS = 30
_ENDED = (
    "BOOT_FAIL", "CANCELLED", "COMPLETED", "DEADLINE", "FAILED", "NODE_FAIL", "OUT_OF_MEMORY", "REVOKED",
    "TIMEOUT",
)  # fmt: skip
_BY_CHANCE = ("BOOT_FAIL", "FAILED", "NODE_FAIL")
"""States of a killed job that might succeed on another node."""


class SlurmLauncher(submitit_launcher.SlurmLauncher):
    """Runs jobs as one Slurm array; each is pickled into, and answers in, ``submitit_folder``."""

    def launch(self, job_overrides: Sequence[Sequence[str]], initial_job_idx: int) -> Sequence[JobReturn]:
        """Submit, wait for all; a lost job's return is a failure. An interrupt cancels what still runs."""
        self._close_folder()
        executor = self._executor()
        assert self.config is not None
        folder = Path(str(self.config.hydra.sweep.dir))
        folder.mkdir(parents=True, exist_ok=True)
        here = f"hydra.sweep.dir='{folder}'"  # its name holds the time, and a job has a time of its own
        arguments = []
        for number, overrides in enumerate(job_overrides, initial_job_idx):
            log.info(f"\t#{number} : {' '.join(filter_overrides(overrides))}")
            key = f"job_id_for_{number}"
            arguments.append(([*overrides, here], "hydra.sweep.dir", number, key, Singleton.get_state()))
        with _cancelled_if_interrupted(executor.map_array(self, *zip(*arguments, strict=True))) as jobs:
            log.info(f"submitted to Slurm as job {jobs[0].job_id.partition('_')[0]}; squeue shows it")
            return [_outcome(job, given) for job, given in zip(jobs, job_overrides, strict=True)]

    def _close_folder(self) -> None:
        """Let nobody else read the pickled jobs, or put other ones in their place."""
        folder = Path(str(self.params["submitit_folder"]).partition("%")[0])
        folder.mkdir(parents=True, exist_ok=True)
        try:
            folder.chmod(0o700)
        except PermissionError as error:
            raise ConfigError(
                f"{folder} is not yours: the jobs that are handed over there would run"
            ) from error

    def _executor(self) -> Any:
        import submitit

        own = {f"slurm_{k}": v for k, v in self.params.items() if k == "max_num_timeout"}
        try:
            executor = submitit.AutoExecutor(
                folder=self.params["submitit_folder"], cluster=self._EXECUTOR, **own
            )
        except RuntimeError as error:
            raise ValueError(
                "launcher=slurm: this machine has no Slurm (srun is not found); "
                "launcher=joblib runs jobs side by side here"
            ) from error
        executor.update_parameters(
            **{
                key if key in _OF_EVERY_EXECUTOR else f"slurm_{key}": value
                for key, value in self.params.items()
                if key not in _OF_THE_LAUNCHER
            }
        )
        return executor


@contextmanager
def _cancelled_if_interrupted(jobs: Sequence[Job[JobReturn]]) -> Iterator[Sequence[Job[JobReturn]]]:
    queue = queue_of_slurm()
    for job in jobs:
        job.watcher = queue
        queue.register_job(job.job_id)
    try:
        yield jobs
    except BaseException:
        for job in jobs:
            job.cancel(check=False)
        raise


def _outcome(job: Job[JobReturn], overrides: Sequence[str]) -> JobReturn:
    """Wait for the job; what it returned, or that it was lost."""
    from submitit.core.utils import FailedJobError, UncompletedJobError

    try:
        return job.results()[0]
    except (FailedJobError, UncompletedJobError) as error:
        # the first raised an exception: its result is there before squeue tells its end
        state = "FAILED" if isinstance(error, FailedJobError) else job.state
        by_chance = isinstance(error, UncompletedJobError) and state in _BY_CHANCE
        why = f"Slurm job {job.job_id} is lost ({state.lower()}); its log: {job.paths.stderr}"
        log.info(f"{why}; it was {' '.join(filter_overrides(overrides))}")
        lost = JobReturn(overrides=overrides, status=JobStatus.FAILED)
        lost.return_value = LostJob(why, by_chance)
        return lost


def queue_of_slurm() -> Any:
    """Asks ``squeue`` for the states of jobs: unlike ``sacct`` it is always there."""
    from submitit.slurm.slurm import SlurmInfoWatcher

    class Queue(SlurmInfoWatcher):
        def _make_command(self) -> list[str] | None:
            command = ["squeue", "--me", "--array", "--states=all", "--format=%i|%T|%N"]
            return command if self._registered - self._finished else None

        def read_info(self, string: bytes | str) -> dict[str, dict[str, str]]:
            text = string.decode() if isinstance(string, bytes) else string
            return states(text, self._registered - self._finished)  # Slurm forgets, we do not

    return Queue(delay_s=_SECONDS_BETWEEN_LOOKS)


def states(said: str, jobs: set[str]) -> dict[str, dict[str, str]]:
    """The state of each of ``jobs`` by what ``squeue`` said; it forgets a job minutes after its end."""
    rows: Mapping[str, list[str]] = {
        row[0].strip(): row for line in said.splitlines() if len(row := line.split("|")) == 3
    }
    found = {}
    for job in jobs:
        _, state, node = rows.get(job, (job, "GONE", ""))
        ended = state in _ENDED or state == "GONE"
        found[job] = {"JobID": job, "State": state if ended else "RUNNING", "NodeList": node}
    return found
