"""A small sound record, and the same with something changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from hybridid.records.record import Channel, Record


@pytest.fixture
def make_record() -> Callable[..., Record]:
    """``make_record(n, seed, **changes)``: noise in five signals at 1 kHz."""

    def make(n: int = 200, seed: int = 0, **changes: Any) -> Record:
        noise = np.random.default_rng(seed).normal(size=(n, 5))
        parts = {
            "name": "bench",
            "time": np.arange(n) * 1e-3,
            "inputs": noise[:, :2],
            "outputs": noise[:, 2:4],
            "auxiliary": noise[:, 4:],
            "input_channels": (Channel("force", "N", "zoh", "drive"), Channel("road", "m", "foh")),
            "output_channels": (Channel("position", "m"), Channel("angle", "rad")),
            "auxiliary_channels": (Channel("reference", "m"),),
            "source": "bench.mat",
            "digest": "0" * 64,
        }
        return Record(**{**parts, **changes})

    return make
