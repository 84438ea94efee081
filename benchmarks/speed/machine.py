"""The machine that a benchmark ran on, as its system tells it."""

from __future__ import annotations

import os
import platform
from importlib.metadata import version
from pathlib import Path

PACKAGES = ("hybridid", "casadi", "numpy", "scipy", "numba", "torch")


def machine() -> dict[str, str | int | float]:
    """The processor, the cores that this process may use, the load, Python and the packages that decide."""
    return {
        "processor": next(iter(_told("model name")), platform.machine()),
        "cores": len(os.sched_getaffinity(0)),
        "load": os.getloadavg()[0],
        "python": platform.python_version(),
        **{name: version(name) for name in PACKAGES},
    }


def cycles_a_second() -> float:
    """Of the fastest core, at this moment; nan where the system does not tell it."""
    return 1e6 * max(map(float, _told("cpu MHz")), default=float("nan"))


def _told(key: str) -> list[str]:
    """What ``/proc/cpuinfo`` says of every core; empty where there is no such file."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return []
    return [line.split(":", 1)[1].strip() for line in lines if line.startswith(key)]
