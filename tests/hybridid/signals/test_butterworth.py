"""The filters have the gain and phase of their formula, start without a transient, and refuse nonsense."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.signals.butterworth import Butterworth, low_frequency_delay
from hybridid.signals.step import StepError

DT = 1e-3
MIDDLE = slice(3000, 7000)  # of 10000 samples: settled


def gain(f: float, cutoff: float, order: int, kind: str) -> float:
    """|H| of the digital filter: the bilinear transform maps f to tan(π f dt)."""
    ratio = np.tan(np.pi * f * DT) / np.tan(np.pi * cutoff * DT)
    return 1 / np.sqrt(1 + (ratio if kind == "low" else 1 / ratio) ** (2 * order))


def component(x: np.ndarray, f: float, n: int) -> complex:
    """The complex amplitude of cos(2πft) in x over the settled middle."""
    t = np.arange(n) * DT
    return 2 * np.mean((x * np.exp(-2j * np.pi * f * t))[MIDDLE])


@pytest.mark.parametrize("kind", ["low", "high"])
@pytest.mark.parametrize("order", [1, 2, 4, 7])
@pytest.mark.parametrize("f", [5.0, 20.0, 40.0, 125.0])
def test_gain_and_phase_of_a_sine(record_of, kind, order, f):
    record = record_of(y=lambda t: np.cos(2 * np.pi * f * t), n=10000)
    expected = gain(f, 20.0, order, kind)
    twice = Butterworth(("position",), 20.0, order, kind).apply(record)
    assert component(twice.output("position"), f, 10000) == pytest.approx(expected**2, abs=2e-4)
    once = Butterworth(("position",), 20.0, order, kind, zero_phase=False).apply(record)
    assert abs(component(once.output("position"), f, 10000)) == pytest.approx(expected, abs=2e-4)


def test_band_pass_keeps_its_band_only(record_of):
    f = np.array([2.0, 20.0, 200.0])
    record = record_of(y=lambda t: np.cos(2 * np.pi * f[:, None] * t).sum(axis=0), n=10000)
    y = Butterworth(("position",), (10.0, 40.0), 4, "band").apply(record).output("position")
    amplitudes = [abs(component(y, one, 10000)) for one in f]
    assert amplitudes[1] == pytest.approx(1.0, abs=0.01)
    assert max(amplitudes[0], amplitudes[2]) < 1e-4


@pytest.mark.parametrize("zero_phase", [True, False])
@pytest.mark.parametrize("cutoff", [2.0, 10.0, 400.0])
def test_a_constant_passes_a_low_pass_from_the_first_sample_on(record_of, zero_phase, cutoff):
    record = record_of(y=lambda t: 0.25 + 0 * t)
    y = Butterworth(("position",), cutoff, zero_phase=zero_phase).apply(record).output("position")
    np.testing.assert_allclose(y, 0.25, atol=1e-8)
    high = Butterworth(("position",), cutoff, kind="high", zero_phase=zero_phase).apply(record)
    np.testing.assert_allclose(high.output("position"), 0.0, atol=1e-8)


def test_zero_phase_keeps_a_line_to_its_ends(record_of):
    record = record_of(y=lambda t: 3 - 2 * t)
    y = Butterworth(("position",), 5.0).apply(record).output("position")
    np.testing.assert_allclose(y, record.output("position"), atol=1e-3)


@pytest.mark.parametrize(("order", "cutoff"), [(1, 10.0), (2, 25.0), (4, 50.0), (6, 8.0)])
def test_a_causal_low_pass_delays_a_ramp_by_what_it_says(record_of, order, cutoff):
    record = record_of(y=lambda t: 2 * t, n=4000)
    y = Butterworth(("position",), cutoff, order, zero_phase=False).apply(record).output("position")
    lag = (record.output("position") - y)[-500:] / 2
    # the formula is the analogue filter's, the digital one differs by a fraction of a sample
    np.testing.assert_allclose(lag, low_frequency_delay(order, cutoff), rtol=0.02)


@pytest.mark.parametrize("seed", range(3))
def test_causal_means_blind_to_the_future(record_of, seed):
    noise = np.random.default_rng(seed).normal(size=2000)
    changed = noise.copy()
    changed[1200:] += 5.0
    step = Butterworth(("position",), 30.0, zero_phase=False)
    a, b = (step.apply(record_of(y=lambda t, x=x: x)).output("position") for x in (noise, changed))
    assert np.array_equal(a[:1200], b[:1200])
    assert not np.array_equal(a[1200:], b[1200:])


@pytest.mark.parametrize("seed", range(3))
def test_zero_phase_does_not_know_which_way_time_runs(record_of, seed):
    noise = np.cumsum(np.random.default_rng(seed).normal(size=2000))
    step = Butterworth(("position",), 30.0)
    a, b = (step.apply(record_of(y=lambda t, x=x: x)).output("position") for x in (noise, noise[::-1]))
    # the pads forget the far end to a thousandth
    np.testing.assert_allclose(a, b[::-1], atol=2e-2)
    np.testing.assert_allclose(a[200:-200], b[::-1][200:-200], atol=1e-6)


def test_any_signal_may_be_filtered_and_only_the_named_ones_are(record_of):
    record = record_of(y=lambda t: np.sin(900 * t), u=lambda t: np.sin(800 * t))
    filtered = Butterworth(("force", "reference"), 20.0).apply(record)
    assert np.ptp(filtered.input("force")[500:1500]) < 1e-3
    assert np.ptp(filtered.signal("reference")[500:1500]) < 1e-3
    assert np.array_equal(filtered.outputs, record.outputs)
    assert filtered.input_channels == record.input_channels
    assert filtered.digest == record.digest
    assert np.ptp(record.input("force")) > 1.9


def test_a_record_shorter_than_the_transient_is_refused(record_of):
    """Rather than returned as if filtered: its ends would reach each other."""
    record = record_of(y=lambda t: 1 + t, n=40)
    y = Butterworth(("position",), 50.0).apply(record).output("position")
    np.testing.assert_allclose(y, record.output("position"), atol=1e-3)
    with pytest.raises(StepError, match=r"the filter needs 1\d\d\d samples to settle, there are 40"):
        Butterworth(("position",), 1.0).apply(record)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (
            {"cutoff": 500.0},
            "cutoff is 500 Hz, it must be below 500 Hz, the Nyquist frequency of record bench",
        ),
        ({"cutoff": (10.0, 700.0), "kind": "band"}, "cutoff is 700 Hz, it must be below 500 Hz"),
        ({"cutoff": 0.0}, "must be positive"),
        ({"cutoff": (40.0, 10.0), "kind": "band"}, "rising if there are two"),
        ({"cutoff": (10.0, 40.0)}, "does not suit low: band needs two"),
        ({"cutoff": 10.0, "kind": "band"}, "does not suit band: band needs two"),
        ({"cutoff": 10.0, "order": 0}, "order is 0, allowed: 1 to 20"),
        ({"cutoff": 10.0, "order": 21}, "order is 21, allowed: 1 to 20"),
    ],
)
def test_impossible_values(record_of, values, said):
    with pytest.raises(StepError, match=said):
        Butterworth(("position",), **values).apply(record_of())
