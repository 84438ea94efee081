"""Records whose signals are known functions of time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from hybridid.records.record import Channel, Record

Function = Callable[[np.ndarray], np.ndarray]


@pytest.fixture
def record_of() -> Callable[..., Record]:
    """``record_of(y, u, n, dt, hold)``: output ``position``, input ``force``, auxiliary ``reference``."""

    def make(
        y: Function = np.sin, u: Function = np.cos, n: int = 2000, dt: float = 1e-3, hold: str = "zoh"
    ) -> Record:
        t = np.arange(n) * dt
        return Record(
            name="bench",
            time=t,
            inputs=u(t)[:, None],
            outputs=y(t)[:, None],
            input_channels=(Channel("force", "N", hold),),
            output_channels=(Channel("position", "m"),),
            auxiliary=y(t)[:, None] + 1.0,
            auxiliary_channels=(Channel("reference", "m"),),
            digest="ab",
        )

    return make
