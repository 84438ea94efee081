"""What a task is estimated to need, beside what it takes."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hybridid.estimators.demand import fit_demand
from hybridid.estimators.fit import fit
from hybridid.residuals.demand import training_demand
from hybridid.residuals.orders import Orders
from hybridid.residuals.series import ErrorSeries, Surroundings
from hybridid.residuals.settings import Architecture, Training
from hybridid.residuals.training import Task, train_stack
from hybridid.rigs.emps import EMPSRig
from hybridid.settings.fit import FitSettings

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads the peak of the memory in /proc")


def peak(work: Callable[[], object]) -> float:
    """Bytes that ``work`` takes at its peak beside those that were there before, in a process of its own."""
    ours, theirs = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            Path("/proc/self/clear_refs").write_text("5")  # the peak counts from here
            before = _status("VmRSS")
            work()
            os.write(theirs, str(_status("VmHWM") - before).encode())
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    os.close(theirs)
    with os.fdopen(ours) as said:
        return float(said.read())


def _status(name: str) -> int:
    (line,) = (x for x in Path("/proc/self/status").read_text().splitlines() if x.startswith(name))
    return int(line.split()[1]) * 1024


def errors(n: int) -> ErrorSeries:
    values = np.random.default_rng(1).normal(size=(3, n))
    return ErrorSeries(
        "r", "simulated", values[0], Surroundings("y", "m", 0.01, values[1:2].T, ("u",), values[2], (0,))
    )


@pytest.mark.parametrize(
    ("size", "n", "copies", "training"),
    [
        (Architecture(Orders(2, (2,), 2), 2, 1500), 150, 1, Training((1,), epochs=1, batch=64)),
        (Architecture(Orders(2, (2,), 2), 3, 16), 20_000, 9, Training((50,), epochs=1, batch=51_200)),
    ],
    ids=["wide", "large batches"],
)
def test_memory_of_a_training_within_a_factor_of_two(size, n, copies, training):
    tasks = [Task((errors(n),), size, seed) for seed in range(copies)]
    taken = peak(lambda: train_stack(tasks, training))
    assert 0.5 < training_demand([size], copies, n, training).memory / taken < 2.0


def test_memory_of_a_fit_within_a_factor_of_two(make_model):
    record = EMPSRig().record("identification", 0, 30.0)
    settings = FitSettings(max_iterations=1, continuation=(1.0,), start="guess")
    model = make_model()
    taken = peak(lambda: fit(model, [record], settings))
    assert 0.5 < fit_demand(model, [record], settings).memory / taken < 2.0


def test_what_a_fit_needs_grows_with_what_makes_it_large(make_model):
    record, model, usual = EMPSRig().record("identification", 0, 2.0), make_model(), FitSettings()
    one = fit_demand(model, [record], usual)
    finer = fit_demand(model, [record], replace(usual, substeps=10**6))
    assert finer.seconds > 1e5 * one.seconds / 10
    assert finer.keys == ("estimator.substeps (1000000)",)
    more = fit_demand(model, [record], replace(usual, starts=10**9))
    assert more.memory > 1e11
    assert more.keys == ("estimator.starts (1000000000)",)
    wide = fit_demand(model, [record], usual, nodes=10_000)
    assert wide.memory > 1e11
    assert wide.keys == ("residual.nodes (10000)",)


@pytest.mark.parametrize(
    ("size", "key"),
    [
        (Architecture(Orders(2, (2,), 2), 3, 10**6), "residual.width (1000000)"),
        (Architecture(Orders(2, (2,), 2), 10**6, 16), "residual.depth (1000000)"),
        (Architecture(Orders(10**9, (2,), 2), 3, 16), "residual.orders (1000000000)"),
    ],
)
def test_the_number_that_makes_a_training_large_is_named(size, key):
    found = training_demand([size], 3, 1000, Training())
    assert found.keys == (key,)
    assert found.memory > 1e10
