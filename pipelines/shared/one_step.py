"""Records that are simulated together need one sampling time; which key makes it so where they differ."""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.naming import listed
from hybridid.records.checks import have_one_step
from pipelines.shared.errors import ConfigError
from pipelines.shared.prepared import Prepared


def check_one_step(records: Sequence[Prepared]) -> None:
    """Check that all have the same step. The shortest is proposed: no sample is lost, none folds down.

    Raises:
        ConfigError: if they have not; the message gives the keys that make it so.
    """
    finest = min(records, key=lambda one: one.dt)
    coarser = [one for one in records if not have_one_step(one, finest)]
    if coarser:
        step = f"{finest.dt:.12g}"
        differ = listed([f"{one.name} ({one.dt:.6g} s)" for one in coarser])
        raise ConfigError(
            f"records differ in sampling time: {differ} from {finest.name} ({step} s); set "
            + " ".join(f"records.{one.name}.resample={step}" for one in coarser)
        )
