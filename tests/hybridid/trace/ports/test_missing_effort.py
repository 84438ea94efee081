"""A force planted in a simulated carriage, and hidden from its record, comes back inside its band."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.simulation.stability import TooStiff
from hybridid.trace.ports.missing_effort import SINCE_REVERSAL, missing_effort
from hybridid.trace.results import missing_efforts
from hybridid.trace.results.missing_efforts import Failure, in_words

N, NOISE = 800, 2e-6


def planted(time):
    """Slow, fast and sudden, N."""
    return 4.0 * np.sin(2 * np.pi * 0.6 * time) + 3.0 * (time > 2.0)


@pytest.fixture(scope="module")
def found(carriage_like, make_model, noise):
    @dataclass(frozen=True)
    class Pushed(carriage_like):
        def force(self, time):
            return super().force(time) - planted(time)

    honest, pushed = carriage_like(), Pushed()
    record = pushed.record(N, noise=noise(N, NOISE, seed=5))
    record = replace(record, inputs=honest.force(record.time)[:, None])
    return missing_effort(make_model(), honest.truth, record, "carriage")


def test_the_force_comes_back(found):
    inner = slice(20, N - 20)
    error = (found.effort - planted(found.time))[inner]
    jump = np.abs(found.time[inner] - 2.0) < 0.1
    assert np.sqrt(np.mean(error[~jump] ** 2)) < 0.5
    assert np.corrcoef(found.effort[inner], planted(found.time)[inner])[0, 1] > 0.98


def test_its_band_holds_it(found):
    """95 % bands hold the truth at about 95 % of the samples, and are no wider than they must be."""
    away = np.abs(found.time - 2.0) > 0.1
    inside = np.abs(found.effort - planted(found.time)) < 1.96 * found.std
    assert 0.9 < inside[away].mean() <= 1.0
    assert np.median(found.std) < 1.0


def test_it_says_whose_it_is(found):
    assert (found.port, found.unit, found.provenance) == ("carriage", "N", "simulated")
    assert found.kind == "effort"
    assert {name: unit for name, (_, unit) in found.motion.items()} == {
        "velocity": "m/s", "position": "m", "acceleration": "m/s²", SINCE_REVERSAL: "m"
    }  # fmt: skip
    assert {len(found.time), len(found.effort), *(len(seen) for seen, _ in found.motion.values())} == {N}


def test_travel_since_the_last_reversal(found):
    velocity, since_reversal = (found.motion[name][0] for name in ("velocity", SINCE_REVERSAL))
    turned = np.flatnonzero(np.diff(np.sign(velocity)) != 0) + 1
    assert len(turned) > 3
    assert since_reversal[turned] == pytest.approx(0.0, abs=1e-12)
    assert (since_reversal >= 0).all()
    span = slice(turned[1], turned[2])
    assert (np.diff(since_reversal[span]) >= -1e-9).all()


def test_nothing_is_missing_where_nothing_is(carriage, make_model, noise):
    record = carriage.record(N, noise=noise(N, NOISE, seed=6))
    found = missing_effort(make_model(), carriage.truth, record, "carriage")
    inside = np.abs(found.effort[20:-20]) < 1.96 * found.std[20:-20]
    assert inside.mean() > 0.9
    assert np.sqrt(np.mean(found.effort[20:-20] ** 2)) < 0.3


def test_a_signal_lacks_no_effort(carriage, make_model):
    with pytest.raises(ValueError, match="port force is of kind input"):
        missing_effort(make_model(), carriage.truth, carriage.record(200), "force")


def test_a_smoother_that_diverges_says_so(carriage, make_model, monkeypatch):
    def diverging(a, mean, *_):
        return np.full_like(mean, np.nan), np.zeros(len(mean))

    monkeypatch.setattr("hybridid.trace.ports.kalman.smooth", diverging)
    with pytest.raises(ArithmeticError, match="the smoother diverges"):
        missing_effort(make_model(), carriage.truth, carriage.record(200), "carriage")


def test_places_that_fail_alike_are_told_in_one_line():
    failures = [Failure("effort", place, "too stiff") for place in ("a on r, m", "b on r, m")]
    failures.append(Failure("flow", "c on r, m", "too stiff"))
    assert in_words(failures) == (
        "missing effort at a on r, m and b on r, m: too stiff",
        "missing flow at c on r, m: too stiff",
    )


def test_a_model_too_stiff_for_the_estimate_is_not_advised_another_integrator(monkeypatch):
    def too_stiff(*given):
        raise TooStiff("set estimator.integrator to rodas3")

    monkeypatch.setattr(missing_efforts, "missing_effort", too_stiff)
    plant = SimpleNamespace(port=lambda name: SimpleNamespace(kind="effort"))
    fitted = SimpleNamespace(
        name="gray box", model=SimpleNamespace(plant=plant), estimate=SimpleNamespace(values={})
    )
    (said,) = in_words([missing_efforts._attempt(fitted, SimpleNamespace(name="rec1"), "guide")])
    assert said == (
        "missing effort at guide on rec1, gray box: it is estimated with RK4, and the model needs more than "
        "50 steps a sample"
    )
