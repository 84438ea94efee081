"""A sweep of many jobs on the one-node Slurm, one of them killed on purpose: is anything lost but that one?

The sweep must log all others, name the one, say so by its exit code, and complete it when started again.
``make study-slurm``; needs slurm-wlm and munge. Simulated data: the virtual rig of the EMPS.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from benchmarks.slurm.jobs import Kill, again, cluster, struck

NETWORK = (
    "case=emps", "data=simulated", "rig.duration=1.2", "residual=narx", "residual.orders.error=2",
    "residual.orders.inputs=1", "residual.orders.gray=1", "residual.depth=1", "residual.width=4",
    "residual.every=5", "residual.horizons=[1]", "residual.epochs=5",
)  # fmt: skip
GRAY = 1  # array that comes before that of the points: the gray box
LOGGED = """
import collections, json
from mlflow.tracking import MlflowClient
store = MlflowClient("sqlite:///outputs/mlflow.db")
runs = store.search_runs([store.get_experiment_by_name("emps").experiment_id], max_results=5000)
parents = [run for run in runs if "mlflow.parentRunId" not in run.data.tags]
children = [run for run in runs if "mlflow.parentRunId" in run.data.tags]
print(json.dumps({
    "parents": [run.info.status for run in parents],
    "children": collections.Counter(run.info.status for run in children),
    "nested": all(run.data.tags["mlflow.parentRunId"] == parents[0].info.run_id for run in children),
    "different": len({run.data.tags["hybridid.key"] for run in runs}) == len(runs),
    "failed": [[r.info.run_name, r.data.tags["error"]] for r in children if r.info.status == "FAILED"],
}))
"""


def main() -> int:
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("--jobs", type=int, default=64)
    given = asked.parse_args()
    environment = cluster()
    folder = Path("outputs") / "slurm-study" / time.strftime("%Y-%m-%d_%H-%M-%S")
    folder.mkdir(parents=True)
    print(f"{given.jobs} jobs in {folder}", flush=True)
    sound = study(given.jobs, folder.resolve(), environment)
    print("as it must be" if sound else "NOT as it must be")
    return 0 if sound else 1


def study(jobs: int, folder: Path, environment: dict[str, str]) -> bool:
    """Sweep, kill one, sweep again; whether both did what they must."""
    command = [sys.executable, "-m", "hybridid_cli", "sweep", *NETWORK, "launcher=slurm", "sweep.stack=1"]
    command += [f"residual.seeds=range(0,{jobs})"]
    _, code, said = struck(command, folder, environment, Kill(array=GRAY, oldest=1.0))
    named = [
        line for line in said.splitlines() if f"1 of {jobs} points have no result: residual.seeds=" in line
    ]
    print(f"  {named[0] if named else 'the killed job is NOT named'}")
    logged = logged_runs(folder, environment)
    sound = code != 0 and bool(named) and logged["children"] == {"FINISHED": jobs - 1, "FAILED": 1}
    sound = sound and logged["parents"] == ["FAILED"] and logged["nested"] and logged["different"]

    code, said = again(command, folder, environment)
    print("\n".join(f"  {line}" for line in said.splitlines() if "fresh" in line or "have results" in line))
    logged = logged_runs(folder, environment)
    sound = sound and code == 0 and logged["children"] == {"FINISHED": jobs}
    return bool(sound and logged["parents"] == ["FINISHED"] and logged["nested"] and logged["different"])


def logged_runs(folder: Path, environment: dict[str, str]) -> dict[str, Any]:
    """What MLflow holds, printed and returned."""
    words = [sys.executable, "-c", LOGGED]
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    print(f"  MLflow: sweep {found['parents']}, points {found['children']}, all nested: {found['nested']}")
    print(f"  none doubled: {found['different']}; failed: {found['failed'] or 'none'}", flush=True)
    return found


if __name__ == "__main__":
    sys.exit(main())
