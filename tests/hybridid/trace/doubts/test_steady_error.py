"""An error that does not grow with the horizon may be a noise with a memory: the records do not decide."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from hybridid.trace.context import Context
from hybridid.trace.doubts.steady_error import steady_over
from hybridid.trace.run import trace

TRIED = ("quadratic_drag", "asymmetric_viscous")
N, LOUD, MEMORY = 6000, 1e-4, 0.9


def coloured(seed: int) -> np.ndarray:
    """A noise of ``LOUD`` m with a memory of ten samples, (N,)."""
    white = np.random.default_rng(seed).normal(0.0, LOUD * np.sqrt(1 - MEMORY**2), N)
    return lfilter([1.0], [1.0, -MEMORY], white)


@pytest.fixture(scope="module")
def traced(make_model, carriage_like):
    """``traced(**truth)``: the trace of a carriage with a noise that has a memory."""

    def make(**truth):
        records = [carriage_like(**truth).record(N, noise=coloured(k), name=f"r{k}") for k in range(2)]
        return trace(
            make_model(), records[:1], records[1:], effects=TRIED, variables=("velocity",), horizon=3.0
        )

    return make


def test_a_noise_with_a_memory_leaves_it_undecided(traced):
    found = traced()
    assert found.times > found.rules.far
    assert found.verdict == "undecided"
    assert found.steady == pytest.approx(found.horizon / 10)
    assert (
        "it may be a noise with a memory, an error of the sensor, or an effect that is faster" in found.words
    )


def test_what_a_missing_effort_does_grows_with_the_horizon(traced):
    found = traced(df_v=300.0)
    assert found.verdict == "effect_found"
    assert found.steady is None
    assert steady_over(found.shown.conclusion.search.first, Context(found.shown.split)) is None
