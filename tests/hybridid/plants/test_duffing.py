"""The oscillator on a truth by SciPy and on the measured Silverbox."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import odeint

from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.plants.duffing import Duffing
from hybridid.records.mapping import build_record, record_map
from hybridid.records.record import Channel, Record
from hybridid.signals.steps import apply_steps
from hybridid.validation.metrics import metrics
from hybridid.validation.predict import free_run

TRUTH = {"m": 5e-6, "d": 2.2e-4, "k": 1.0, "V2_0": 1e-3, "oscillator.cubic_stiffness.k_3": 4.0}
RATE = 610.35
ONCE = FitSettings(continuation=(1.0,))
"""Nothing here has a sign to smooth."""


def test_a_cubic_spring_is_recovered():
    """A noisy input, straight between its samples; half a millivolt of noise on the output."""
    random = np.random.default_rng(3)
    n = 1500
    time = np.arange(n) / RATE
    force = np.convolve(random.normal(size=n), np.hanning(7) / 3, mode="same") * 0.05

    def rate(t, x):
        spring = TRUTH["k"] * x[0] + TRUTH["oscillator.cubic_stiffness.k_3"] * x[0] ** 3
        return [x[1], (np.interp(t, time, force) - TRUTH["d"] * x[1] - spring) / TRUTH["m"]]

    states = odeint(rate, [0, 0], time, tfirst=True, rtol=1e-7, atol=1e-9, hmax=1 / RATE)
    measured = states[:, 0] + TRUTH["V2_0"] + 5e-4 * random.normal(size=n)
    record = Record(
        "oscillator",
        time,
        force[:, None],
        measured[:, None],
        (Channel("V1", "V", "foh"),),
        (Channel("V2", "V"),),
    )
    known = {"oscillator.cubic_stiffness.q_0": {"fixed": 0.0}}
    estimate = fit(compose(Duffing(), ["cubic_stiffness"], known), [record], ONCE)
    for p in estimate.parameters:
        assert abs(p.value - TRUTH[p.name]) < 4 * p.std
        assert p.value == pytest.approx(TRUTH[p.name], rel=0.05)
    assert estimate.cost == pytest.approx(0.5 * n * 5e-4**2 / measured.var(), rel=0.1)


@pytest.fixture(scope="module")
def silverbox(measured: Path) -> tuple[Record, Record]:
    """Two realisations of the multisine, and the arrow of growing amplitude."""
    plan = record_map(
        {
            "files": "silverbox/SNLS80mV.csv",
            "time": {"rate": RATE},
            "inputs": {"V1": {"column": "V1", "unit": "V", "hold": "bandlimited"}},
            "outputs": {"V2": {"column": "V2", "unit": "V"}},
        }
    )
    files = [measured / file for file in plan.files]
    whole = build_record("silverbox", files, plan.time, plan.inputs, plan.outputs)
    unbiased = {"step": "remove_mean", "signals": ["V1"]}
    parts = {"multisine": [40650, 58000], "arrow": [0, 40400]}
    cut = [
        replace(apply_steps(whole, [{"step": "crop", "samples": samples}, unbiased]), name=name)
        for name, samples in parts.items()
    ]
    return cut[0], cut[1]


def arrow_error(effects: list[str], silverbox: tuple[Record, Record]) -> float:
    """RMSE on the arrow in mV, free-running, after a fit to the multisine."""
    multisine, arrow = silverbox
    model = compose(Duffing(), effects)
    estimate = fit(model, [multisine], ONCE)
    assert estimate.converged
    return metrics(free_run(model, estimate.values, arrow), "gray box")[0].rmse * 1e3


def test_the_linear_oscillator_misses_the_growing_arrow(silverbox):
    assert 12 < arrow_error([], silverbox) < 16


def test_the_cubic_spring_meets_it(silverbox):
    """From 14 mV to less than half a millivolt, on amplitudes that the fit has not seen."""
    assert arrow_error(["cubic_stiffness"], silverbox) < 0.5
