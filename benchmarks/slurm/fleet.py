"""A fleet of simulated machines, traced on the one-node Slurm, one worker killed in the middle of its trace.

The table must hold a verdict for each machine, and the same command again must find all of them done.
``make study-fleet``; needs slurm-wlm and munge. Simulated data: the virtual rig of the EMPS. Each machine has
a mass, friction and a seed of its own. One in four lacks nothing, the others hide one law each.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from benchmarks.slurm.jobs import Kill, again, cluster, struck

HIDDEN: tuple[dict[str, Any] | None, ...] = (
    None,
    {"law": "cubic_stiffness", "k_3": 5000.0, "q_0": 0.12},
    {"law": "stribeck", "amplitude": 8.0, "velocity": 0.01},
    {"law": "asymmetric_viscous", "difference": 60.0},
)
"""What a machine hides, in turn."""
TRIED = ("asymmetric_viscous", "stribeck", "cubic_stiffness", "quadratic_drag")
ASKED = (
    "case=emps", "data=simulated", "+machine=glob(*)", "estimator.horizon=500", "trace.horizon=0.5",
    "trace.laws=false", f"trace.effects=[{','.join(TRIED)}]", "launcher=slurm",
)  # fmt: skip
YOUNGEST = 8.0  # s that the killed trace has worked: some of its refits are done


def main() -> int:
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("--machines", type=int, default=40)
    asked.add_argument("--at-once", type=int, help="jobs that run at once (default: one a core)")
    given = asked.parse_args()
    environment = cluster()
    folder = (Path("outputs") / "fleet-study" / time.strftime("%Y-%m-%d_%H-%M-%S")).resolve()
    hidden = write_machines(folder / "lab" / "machine", given.machines)
    print(f"{given.machines} machines (simulated) in {folder}", flush=True)
    sound = study(hidden, folder, environment, given.at_once)
    print("as it must be" if sound else "NOT as it must be")
    return 0 if sound else 1


def write_machines(folder: Path, count: int) -> dict[str, str]:
    """A file for each machine; the law that each hides, by its name."""
    folder.mkdir(parents=True)
    draw, hidden = np.random.default_rng(0), {}
    for k in range(count):
        law = HIDDEN[k % len(HIDDEN)]
        truth = {
            "M": float(draw.uniform(85, 105)),
            "f_v": float(draw.uniform(180, 230)),
            "f_c": float(draw.uniform(16, 24)),
            "offset": float(draw.uniform(-3, 3)),
        }
        rig = {"seed": k, "duration": 6.0, "truth": truth, "planted": [law] if law else []}
        name = f"m{k + 1:02}"
        (folder / f"{name}.yaml").write_text(f"# @package _global_\n{yaml.safe_dump({'rig': rig})}")
        hidden[name] = str(law["law"]) if law else ""
    return hidden


def study(
    hidden: Mapping[str, str], folder: Path, environment: dict[str, str], at_once: int | None = None
) -> bool:
    """Trace all, kill one worker; ask again; whether both did what they must."""
    command = [sys.executable, "-m", "hybridid_cli", "trace", "-m", "--config-dir", "lab", *ASKED]
    command += [f"hydra.launcher.array_parallelism={at_once}"] if at_once else []
    kill = Kill(ended=min(len(hidden) // 2, 10), youngest=YOUNGEST, at_once=True)
    killed, code, said = struck(command, folder, environment, kill)
    noted = [line for line in said.splitlines() if "once more" in line]
    print("\n".join(f"  {line}" for line in noted) or "  the killed trace is NOT named")
    sound = bool(killed and noted) and code == 0 and _complete(hidden, folder)

    code, said = again(command, folder, environment)
    fresh = f"{len(hidden)} of them fresh, 0 to do" in said
    print(f"  all machines are done already: {fresh}")
    return sound and fresh and code == 0 and _complete(hidden, folder)


def _complete(hidden: Mapping[str, str], folder: Path) -> bool:
    """Whether the one table holds a verdict for every machine; says what these are."""
    (table,) = (folder / "outputs" / "sweeps").glob("*/fleet.json")
    found = json.loads(table.read_text())
    machines = {one["at"]["machine"]: one for one in found["machines"]}
    print(f"  table: {len(machines)} of {len(hidden)} verdicts, {len(found['failures'])} failures")
    print(f"  verdicts: {dict(Counter(one['verdict'] for one in machines.values()))}")
    right = sum(_right(one, hidden[name]) for name, one in machines.items())
    print(f"  {right} name what the machine hides, or say that nothing is missing", flush=True)
    print(f"  seconds of a trace: median {np.median([one['seconds'] for one in machines.values()]):.1f}")
    return machines.keys() == hidden.keys() and not found["failures"]


def _right(one: Mapping[str, Any], law: str) -> bool:
    lacks = [name for said in one["lacks"] for name in said.removeprefix("one of {").rstrip("}").split(", ")]
    return any(name.endswith(f".{law}") for name in lacks) if law else one["verdict"] == "nothing_missing"


if __name__ == "__main__":
    sys.exit(main())
