"""Dahl, LuGre, Bouc-Wen and Maxwell against closed forms and against textbook variables."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import odeint

F_C, LENGTH = 3.0, 0.01
TIME = np.linspace(0, 4, 2001)


def sliding(speed: float):
    return lambda t: {"position": speed * t, "velocity": speed}


def swinging(amplitude: float, omega: float):
    return lambda t: {
        "position": amplitude * np.sin(omega * t),
        "velocity": amplitude * omega * np.cos(omega * t),
    }


@pytest.mark.parametrize("name", ["dahl", "lugre", "bouc_wen"])
@pytest.mark.parametrize("speed", [-0.5, 0.05, 2.0])
def test_steady_sliding_reaches_the_friction_level(bench, name, speed):
    effect = bench(name, f_c=F_C, s=LENGTH)
    wanted = F_C * np.sign(speed)
    if name == "lugre":
        wanted *= 1 + effect.p["r_s"] * np.exp(-((speed / effect.p["v_s"]) ** 2))
    law, _ = effect.run(sliding(speed), TIME)
    assert law[-1] == pytest.approx(wanted, rel=1e-4)


@pytest.mark.parametrize("name", ["dahl", "lugre", "bouc_wen"])
def test_friction_goes_with_its_level_and_not_its_stiffness(bench, name):
    """At f_c = 0 nothing is left although the initial stiffness per level, 1/s, stays."""
    effect = bench(name, f_c=0.0, s=LENGTH)
    law, z = effect.run(swinging(0.05, 6.0), TIME)
    assert np.array_equal(law, np.zeros_like(law))
    assert np.abs(z).max() > 0.9


def test_dahl_builds_up_over_the_presliding_length(bench):
    """z = 1 - exp(-x/s) from rest, at whatever speed."""
    effect = bench("dahl", f_c=F_C, s=LENGTH)
    for speed in (0.01, 0.3):
        law, _ = effect.run(sliding(speed), TIME)
        assert law == pytest.approx(F_C * (1 - np.exp(-speed * TIME / LENGTH)), abs=1e-5)


@pytest.mark.parametrize("name", ["dahl", "bouc_wen"])
def test_hysteresis_loops_do_not_depend_on_the_rate(bench, name):
    effect = bench(name, f_c=F_C, s=LENGTH)
    slow, _ = effect.run(swinging(0.03, 2 * np.pi), np.linspace(0, 2, 801))
    fast, _ = effect.run(swinging(0.03, 20 * np.pi), np.linspace(0, 0.2, 801))
    assert slow == pytest.approx(fast, abs=1e-4)


def test_bristles_stay_within_their_bounds_under_coarse_steps(bench):
    """RK4 at |v| h/s = 1, the comfortable step, on a rough motion: no runaway, |z| <= 1."""
    rng = np.random.default_rng(8)
    for name in ("dahl", "bouc_wen"):
        v, z, h = np.clip(rng.normal(size=2000), -1, 1), np.zeros(1), LENGTH / 1.0
        rates = bench(name, s=LENGTH).rates(lambda step, v=v: {"velocity": v[step]})
        for step in range(len(v)):
            k = [np.zeros(1)]
            for share in (0.0, 0.5, 0.5, 1.0):
                k.append(rates(step, z + share * h * k[-1]))
            z = z + h / 6 * (k[1] + 2 * k[2] + 2 * k[3] + k[4])
            assert abs(z[0]) <= 1 + 1e-9


def test_a_bristle_at_rest_does_not_creep(bench):
    for name in ("dahl", "lugre", "bouc_wen"):
        law, rates = bench(name)(z=[0.7], velocity=0.0)
        assert rates[0] == 0.0
        assert law != 0.0


def test_lugre_is_the_textbooks(bench):
    """Eqs. 5-9 and 5-10 in their own variables: sigma_0, sigma_1, f_s, f_c, v_s and a bristle in metres."""
    sigma_0, sigma_1, f_s, v_s = 400.0, 1.2, 4.5, 0.3
    motion = swinging(0.05, 3.0)

    def bristle(t, z):
        v = motion(t)["velocity"]
        g = F_C + (f_s - F_C) * np.exp(-((v / v_s) ** 2))
        return [v - sigma_0 * abs(v) / g * z[0]]

    z = odeint(bristle, [0.0], TIME, tfirst=True, rtol=1e-9, atol=1e-12, hmax=1e-3)[:, 0]
    rates = np.array([bristle(t, [now])[0] for t, now in zip(TIME, z, strict=True)])
    wanted = sigma_0 * z + sigma_1 * rates
    ours = bench("lugre", f_c=F_C, s=F_C / sigma_0, tau_b=sigma_1 / sigma_0, r_s=f_s / F_C - 1, v_s=v_s)
    law, _ = ours.run(motion, TIME)
    assert law == pytest.approx(wanted, abs=2e-4 * F_C)
    assert law.max() > 1.1 * F_C, "the motion must pass through the Stribeck velocity"


@pytest.mark.parametrize(("sigma", "n"), [(0.5, 1.0), (0.8, 2.0), (1.0, 3.0)])
def test_bouc_wen_is_the_textbooks(bench, sigma, n):
    """x = A v - beta |v| |x|^(n-1) x - gamma v |x|^n in Wen's variables, with the state in metres."""
    stiffness = F_C / LENGTH
    a = 1.0
    beta, gamma = sigma * LENGTH**-n, (1 - sigma) * LENGTH**-n
    motion = swinging(0.03, 5.0)

    def state(t, x):
        v = motion(t)["velocity"]
        return [a * v - beta * abs(v) * abs(x[0]) ** (n - 1) * x[0] - gamma * v * abs(x[0]) ** n]

    x = odeint(state, [0.0], TIME, tfirst=True, rtol=1e-9, atol=1e-12, hmax=1e-3)[:, 0]
    law, _ = bench("bouc_wen", f_c=F_C, s=LENGTH, sigma=sigma, n=n).run(motion, TIME)
    assert law == pytest.approx(stiffness * x, abs=2e-4 * F_C)


def test_bouc_wen_with_one_and_one_is_dahl(bench):
    dahl, bouc_wen = bench("dahl", s=LENGTH), bench("bouc_wen", s=LENGTH, sigma=1.0, n=1.0)
    for z in (-0.8, 0.1, 0.9):
        for v in (-0.4, 0.7):
            assert bouc_wen(z=[z], velocity=v)[1] == pytest.approx(dahl(z=[z], velocity=v)[1], rel=1e-9)


def test_bouc_wen_differentiates_by_its_sharpness_at_zero(bench):
    assert np.isfinite(bench("bouc_wen", n=1.0).slopes(z=[0.0], velocity=0.0)).all()
    assert np.isfinite(bench("bouc_wen", n=1.0).slopes(z=[0.0], velocity=1.0)).all()


@pytest.mark.parametrize("name", ["maxwell", "second_maxwell", "third_maxwell"])
@pytest.mark.parametrize("omega", [0.3, 10.0, 300.0])
def test_maxwell_has_its_complex_stiffness(bench, name, omega):
    """k i omega tau / (1 + i omega tau): a damper when slow, a spring when fast."""
    k, tau = 40.0, 0.1
    motion, time = swinging(1.0, omega), np.linspace(0, 40 / omega + 1, 4001)
    law, _ = bench(name, k=k, tau=tau).run(motion, time)
    stiffness = k * 1j * omega * tau / (1 + 1j * omega * tau)
    wanted = np.imag(stiffness * np.exp(1j * omega * time))
    settled = time > 8 * tau
    assert law[settled] == pytest.approx(wanted[settled], abs=2e-3 * abs(stiffness))
