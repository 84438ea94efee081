"""Delay, lag, saturation and dead zone on signal paths, against what they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.effects.delay import ORDER, WINDOW


def response(bench, omega: np.ndarray, **p: float) -> np.ndarray:
    """Frequency response of 1 + effect at ``omega`` [rad/s], from its linear equations."""
    n = len(bench.effect.states)
    slopes = bench.slopes(z=[0.0] * n, p=p)
    signal, rate, states = 5, 6, slice(bench.n_seen, bench.n_seen + n)
    c, d, a = slopes[0, states], slopes[0, signal], slopes[1:, states]
    b = slopes[1:, signal] + 1j * omega[:, None] * slopes[1:, rate]
    forced = np.linalg.solve(1j * omega[:, None, None] * np.eye(n) - a, b[..., None])
    return 1 + d + forced[..., 0] @ c


@pytest.mark.parametrize(("upto", "error"), [(1.0, 1e-4), (3.0, 7e-3), (5.0, 9e-2)])
def test_the_delay_is_as_accurate_as_it_says(bench, upto, error):
    """The stated error at the stated frequency, for every delay up to the window."""
    effect = bench("input_delay")
    omega = np.linspace(0, upto / WINDOW, 200)
    worst = 0.0
    for delay in np.linspace(0, WINDOW, 41):
        worst = max(worst, np.abs(response(effect, omega, delay=delay) - np.exp(-1j * omega * delay)).max())
    assert worst <= error
    assert worst > error / 20, "the docstring promises too little"


def test_the_delay_of_a_whole_window_is_the_textbooks_pade_approximant(bench):
    numerator = [1.0, -1 / 2, 3 / 28, -1 / 84, 1 / 1680]
    s = 1j * np.linspace(0, 20, 100)
    pade = np.polyval(numerator[::-1], s) / np.polyval([abs(c) for c in numerator[::-1]], s)
    assert response(bench("input_delay"), s.imag / WINDOW, delay=WINDOW) == pytest.approx(pade, abs=1e-9)


def test_the_delays_poles_do_not_move_with_the_delay(bench):
    effect = bench("input_delay")
    poles = [
        np.linalg.eigvals(
            effect.slopes(z=[0.0] * ORDER, p={"delay": d})[1:, effect.n_seen : effect.n_seen + ORDER]
        )
        for d in (0, 1e-3)
    ]
    assert np.array_equal(poles[0], poles[1])
    assert np.abs(poles[0]).max() < 7 / WINDOW
    assert poles[0].real.max() < 0


def test_the_delay_never_amplifies_and_is_smooth_in_the_delay(bench):
    effect, omega = bench("input_delay"), np.logspace(0, 6, 300)
    delays = np.linspace(0, WINDOW, 101)
    gains = np.array([response(effect, omega, delay=d) for d in delays])
    assert np.abs(gains).max() < 1.2
    assert np.abs(np.diff(gains, axis=0)).max() < 0.3


def test_a_delayed_sine_is_the_sine_of_before(bench):
    delay, omega = 4e-3, 2 * np.pi * 20
    time = np.linspace(0, 0.4, 4001)
    added, states = bench("input_delay", delay=delay).run(lambda t: {"signal": np.sin(omega * t)}, time)
    late = time > 0.1
    wanted = np.sin(omega * (time - delay))
    assert (np.sin(omega * time) + added)[late] == pytest.approx(wanted[late], abs=1e-3)
    assert np.abs(states).max() < 3, "the states are of the signal's size"


@pytest.mark.parametrize("name", ["input_lag", "sensor_lag"])
@pytest.mark.parametrize("time_constant", [2e-3, 2e-2, 0.5])
def test_a_lag_is_first_order_above_its_floor(bench, name, time_constant):
    effect = bench(name)
    ratio = effect.p["floor"] / time_constant
    omega = np.logspace(-1, 1, 50) / time_constant
    error = np.abs(response(effect, omega, T=time_constant) - 1 / (1 + 1j * omega * time_constant)).max()
    assert error <= ratio**2


def test_an_output_that_is_ahead_has_the_inverse_of_a_lag(bench):
    """y + T y' is (1 + T s) y: what a lag 1/(1 + T s) of the recorded input leaves out."""
    lag, omega = 0.02, 30.0
    law = bench("input_record_lag", T=lag).law
    for t in np.linspace(0.0, 0.2, 7):
        y, rate = np.sin(omega * t), omega * np.cos(omega * t)
        lead = 1 + 1j * omega * lag
        assert y + law(signal=y, rate=rate) == pytest.approx(np.imag(lead * np.exp(1j * omega * t)))


@pytest.mark.parametrize("time_constant", [0.0, 1e-4, 1e-3, 1e-2])
def test_a_lag_delays_slow_signals_by_its_time_constant_whatever_the_floor(bench, time_constant):
    omega = 1.0
    phase = np.angle(response(bench("input_lag"), np.array([omega]), T=time_constant))[0]
    assert phase == pytest.approx(-omega * time_constant, abs=1e-6 + 1e-3 * time_constant)


def test_a_lags_pole_stays_within_its_floor(bench):
    effect = bench("input_lag")
    pole = effect.slopes(z=[0.0], p={"T": 0.0})[1, effect.n_seen]
    assert pole == pytest.approx(-1 / effect.p["floor"])


def test_saturation_passes_small_signals_and_holds_large_ones(bench):
    effect = bench("input_saturation", inverse_limit=1 / 8.0)
    out = lambda u: u + effect.law(signal=u)  # noqa: E731
    assert out(0.8) == pytest.approx(0.8, rel=1e-4)
    assert out(80.0) == pytest.approx(8.0, rel=1e-3)
    assert out(-80.0) == -out(80.0)
    u = np.linspace(-50, 50, 1001)
    assert np.diff([out(value) for value in u]).min() > 0
    soft, hard = (
        bench("input_saturation", inverse_limit=1 / 8.0, bend=0.5),
        bench("input_saturation", inverse_limit=1 / 8.0, bend=1 / 12),
    )
    assert soft.law(signal=8.0) < effect.law(signal=8.0) < hard.law(signal=8.0) < 0


def test_dead_zone_loses_its_width_and_nothing_else(bench):
    effect = bench("input_dead_zone", d=0.5)
    width = effect.p["width"]
    out = lambda u: u + effect.law(signal=u)  # noqa: E731
    for u, wanted in ((0.0, 0.0), (0.3, 0.0), (-0.3, 0.0), (2.0, 1.5), (-2.0, -1.5)):
        assert out(u) == pytest.approx(wanted, abs=width / 10)
    assert out(-0.7) == -out(0.7)


def test_a_rate_limit_arrives_by_a_ramp_of_one_slope(bench):
    """Steps of 2 and 8 V at 100 V/s take 20 and 80 ms, both ways."""
    effect, time = bench("input_rate_limit", inverse_rate=0.01), np.linspace(0.0, 0.1, 10001)
    for step in (2.0, 8.0, -8.0):
        added, _ = effect.run(lambda t, to=step: {"signal": to}, time)
        out = step + added
        arrived = abs(step) / 100.0
        half = np.searchsorted(time, arrived / 2)
        assert out[half] == pytest.approx(step / 2, rel=0.01)
        assert out[np.searchsorted(time, arrived + 5e-3)] == pytest.approx(step, rel=0.01)


def test_a_rate_limit_passes_what_is_slow(bench):
    """A sine whose steepest slope is half the rate is late by the floor, no more."""
    effect, time = bench("input_rate_limit", inverse_rate=0.01), np.linspace(0.0, 2.0, 20001)
    omega = 2 * np.pi
    added, _ = effect.run(lambda t: {"signal": 50 / omega * np.sin(omega * t)}, time)
    late = effect.p["floor"]
    assert np.abs(added).max() <= 1.3 * 50 * late


def test_a_bent_characteristic_is_the_same_both_ways(bench):
    """At 10 V a gain that falls by 1 % a volt gives a tenth less."""
    effect = bench("input_nonlinearity", c=-0.01)
    for u in (-10.0, -1.0, 0.0, 2.0, 10.0):
        assert u + effect.law(signal=u) == pytest.approx(u * (1 - 0.01 * abs(u)))


def test_gains_scale_and_offsets_add(bench):
    assert bench("input_gain", g=0.1).law(signal=3.0) == pytest.approx(0.3)
    assert bench("sensor_scale", e=-0.02).law(signal=3.0) == pytest.approx(-0.06)
    assert bench("sensor_offset", b=0.7).law(signal=3.0) == 0.7


@pytest.mark.parametrize(("v", "share"), [(0.0, 1.0), (0.3, 0.7), (0.9, 0.1), (-0.5, 1.5)])
def test_a_back_emf_takes_the_limit_with_the_speed(bench, v, share):
    """At v of a no-load speed of 1 m/s a drive of 8 N gives its share at most, both ways."""
    effect = bench("back_emf_limit", inverse_limit=1 / 8.0, v_0=1.0)
    gives = lambda drive, v: drive - effect.law(drive=drive, velocity=v)  # noqa: E731
    assert gives(80.0, v) == pytest.approx(8.0 * share, rel=0.015)
    assert gives(-80.0, -v) == pytest.approx(-gives(80.0, v))
    assert gives(0.2 * share, v) == pytest.approx(0.2 * share, rel=1e-4)


def test_beyond_its_no_load_speed_a_drive_gives_nearly_nothing(bench):
    effect = bench("back_emf_limit", inverse_limit=1 / 8.0, v_0=1.0)
    given = [80.0 - effect.law(drive=80.0, velocity=v) for v in (0.9, 1.0, 1.5, 5.0)]
    assert np.all(np.diff(given) < 0)
    assert 0 < given[-1] < given[1] < 0.03 * 8.0


def test_at_rest_a_back_emf_limit_is_a_saturation(bench):
    limit, saturation = bench("back_emf_limit"), bench("input_saturation")
    for u in (-40.0, 3.0, 25.0):
        assert limit.law(drive=u) == pytest.approx(-saturation.law(signal=u), rel=0.02)


def test_a_bent_sensor_and_one_with_a_ripple(bench):
    bent = bench("sensor_nonlinearity", c_2=0.03, c_3=-0.01)
    assert bent.law(signal=-2.0) == pytest.approx(0.03 * 4 + 0.01 * 8)
    ripple = bench("sensor_periodic_error", A_s=0.2, A_c=0.1, period=0.5)
    for y in (0.0, 0.13, -3.1):
        assert ripple.law(signal=y + 0.5) == pytest.approx(ripple.law(signal=y))
    assert ripple.law(signal=0.125) == pytest.approx(0.2)
    assert ripple.law(signal=0.25) == pytest.approx(-0.1)
