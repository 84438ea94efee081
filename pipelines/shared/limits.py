"""Limits in memory and time: what a stage needs is estimated before it begins, and refused above them."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from hybridid.demand import Demand
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.sections.stages import LimitsSection
from pipelines.shared.watch import Watcher

GB = 1e9
_PROCESS = 1.5e8
"""Bytes of a worker of its own, beside what it shares with others."""
_POINT, _POINT_SECONDS = 5e4, 0.1
"""Bytes and seconds that each point of a sweep takes at least."""
_LONG = 120.0
"""Seconds above which it is told how long a stage takes at least."""
_CGROUP = Path("/sys/fs/cgroup")


def check_demand(demand: Demand, settings: Settings, cores: int = 1) -> None:
    """Whether ``limits`` allow it, on so many cores.

    Raises:
        ConfigError: if not; says what is needed, what there is, and which keys change it.
    """
    _check(demand, settings.section("limits", LimitsSection), cores)


def check_and_tell(demand: Demand, settings: Settings, watcher: Watcher) -> None:
    """As ``check_demand``; tells how long it takes at least, and which keys make it shorter, if that is long.

    Raises:
        ConfigError: if ``limits`` do not allow it.
    """
    check_demand(demand, settings)
    if demand.seconds > _LONG:
        keys = " or ".join(demand.keys)
        watcher.say(f"{demand.what} takes at least {_time(demand.seconds)}: lower {keys} to make it shorter")


def check_processes(processes: int | None, key: str, settings: Settings) -> None:
    """Whether the memory suffices for so many processes side by side (None: one a core).

    Raises:
        ConfigError: if not.
    """
    if processes is not None:
        what = Demand(f"{processes} processes side by side", processes * _PROCESS, 0.0, (key,))
        check_demand(what, settings)


def check_points(count: int, limits: LimitsSection) -> None:
    """Whether a sweep may have so many points.

    Raises:
        ConfigError: if not.
    """
    what = Demand(
        f"a sweep of {count:,} points", count * _POINT, count * _POINT_SECONDS, ("the number of points",)
    )
    _check(what, limits, 1)


def _check(demand: Demand, limits: LimitsSection, cores: int) -> None:
    memory = available() if limits.memory is None else limits.memory * GB
    hours = demand.seconds / cores / 3600
    if demand.memory > memory:
        there = "free here are" if limits.memory is None else "limits.memory allows"
        needed, offered = f"{_shown(demand.memory / GB)} GB of memory", f"{_shown(memory / GB)} GB"
        raise ConfigError(_line(demand, f"about {needed}", f"{there} {offered}", "limits.memory"))
    if hours > limits.hours:
        offered = f"limits.hours allows {limits.hours:g} h"
        raise ConfigError(_line(demand, f"at least {_shown(hours)} h", offered, "limits.hours"))


def available() -> float:
    """Bytes of memory that this process may still take: of the machine, of its container, of its shell."""
    return min(_offered())


def _offered() -> Iterator[float]:
    yield _of_machine()
    with suppress(OSError, ValueError):  # no container, or one without a limit ("max")
        limit, used = (int((_CGROUP / f"memory.{name}").read_text()) for name in ("max", "current"))
        yield float(max(0, limit - used))
    if sys.platform != "win32":
        import resource

        soft, _ = resource.getrlimit(resource.RLIMIT_AS)
        if soft != resource.RLIM_INFINITY:
            yield float(soft)


def _of_machine() -> float:
    """What Linux says is available, elsewhere all that there is."""
    with suppress(OSError):
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return float(line.split()[1]) * 1024
    if hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    return float("inf")


def _line(demand: Demand, needed: str, offered: str, key: str) -> str:
    keys = " or ".join(demand.keys)
    return f"{demand.what} would take {needed}, and {offered}: lower {keys}, or raise {key}"


def _time(seconds: float) -> str:
    return f"{_shown(seconds / 3600)} h" if seconds >= 3600 else f"{_shown(seconds / 60)} min"


def _shown(value: float) -> str:
    return f"{value:.2g}" if value < 10 else f"{value:.3g}"
