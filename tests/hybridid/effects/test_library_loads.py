"""Load friction, dampers, warmth and the play in series with friction, against plain arithmetic."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.effects.library import effect_named

SIDES = [(3.0, 0.0), (3.0, -3.0), (-2.0, 5.0), (2.0, 5.0), (-4.0, -1.0)]  # drive, load in N
SPEEDS = (-0.4, -0.03, 0.03, 0.4)  # m/s, far beyond epsilon


@pytest.mark.parametrize(("drive", "load"), SIDES)
@pytest.mark.parametrize("v", SPEEDS)
def test_load_friction_is_coulombs_law_on_what_the_contact_carries(bench, drive, load, v):
    seen = {"velocity": v, "drive": drive, "load": load}
    carried = abs(drive - load)
    assert bench("load_friction", mu=0.05).law(**seen) == pytest.approx(0.05 * carried * np.sign(v))
    falling = 0.05 * carried * np.exp(-((v / 0.1) ** 2)) * np.sign(v)
    assert bench("load_stribeck", mu_s=0.05, v_s=0.1).law(**seen) == pytest.approx(falling)
    both = (0.05 * abs(drive) + 0.11 * abs(load)) * np.sign(v)
    assert bench("two_sided_load_friction", mu_d=0.05, mu_l=0.11).law(**seen) == pytest.approx(both)


def test_alike_sides_that_oppose_each_other_are_plain_load_friction(bench):
    one, two = bench("load_friction", mu=0.07), bench("two_sided_load_friction", mu_d=0.07, mu_l=0.07)
    for drive, load in ((3.0, -1.0), (-2.0, 4.0), (5.0, 0.0)):
        seen = {"velocity": 0.3, "drive": drive, "load": load}
        assert two.law(**seen) == pytest.approx(one.law(**seen))


def test_without_a_load_nothing_is_lost(bench):
    for name in ("load_friction", "load_stribeck", "two_sided_load_friction"):
        assert bench(name).law(velocity=0.3) == 0.0
    assert bench("input_scaled_friction").law(velocity=0.3) == 0.0


def test_the_level_scales_the_friction(bench):
    effect = bench("input_scaled_friction", f_u=4.0)
    for level, v in ((0.25, 0.3), (2.0, -0.3), (0.0, 0.3)):
        assert effect.law(velocity=v, level=level) == pytest.approx(4.0 * level * np.sign(v))


def test_an_eddy_brake_is_viscous_slow_and_weaker_beyond_its_critical_velocity(bench):
    effect = bench("eddy_brake", F_m=6.0, v_c=0.2)
    assert effect.law(velocity=0.2) == pytest.approx(6.0)
    assert effect.law(velocity=2e-3) == pytest.approx(2 * 6.0 / 0.2 * 2e-3, rel=1e-3)
    assert effect.law(velocity=20.0) == pytest.approx(2 * 6.0 * 0.2 / 20.0, rel=1e-3)


def test_damping_changes_with_position_and_beyond_the_blow_off(bench):
    assert bench("position_damping", c_q=40.0).law(position=-0.1, velocity=0.5) == pytest.approx(-2.0)
    valve = bench("blow_off_valve", dc=30.0, v_b=0.2)
    assert valve.law(velocity=0.15) == pytest.approx(0.0, abs=1e-4)
    assert valve.law(velocity=0.5) == pytest.approx(-30 * 0.3, rel=1e-4)
    assert valve.law(velocity=-0.5) == pytest.approx(30 * 0.3, rel=1e-4)


def test_a_centrifugal_brake_acts_from_the_speed_at_which_its_shoes_touch(bench):
    brake = bench("centrifugal_brake", k=30.0, v_0=0.2)
    assert brake.law(velocity=0.15) == pytest.approx(0.0, abs=1e-3)
    assert brake.law(velocity=0.5) == pytest.approx(30 * (0.5**2 - 0.2**2), rel=1e-3)
    assert brake.law(velocity=-0.5) == pytest.approx(-30 * (0.5**2 - 0.2**2), rel=1e-3)


def test_warmth_is_the_mean_speed_of_late(bench):
    """Up at constant speed, down in a pause, both with tau."""
    b, tau, v = 3.0, 0.5, 0.4
    effect = bench("warming_friction", b=b, tau=tau)
    time = np.linspace(0, 2, 401)
    law, w = effect.run(lambda t: {"velocity": v if t < 1 else 0.0}, time)
    moving, resting = time < 1, time >= 1.01
    grown = v * (1 - np.exp(-time / tau))
    assert w[moving, 0] == pytest.approx(grown[moving], abs=2e-3)
    assert law[moving] == pytest.approx(-b * grown[moving], abs=6e-3)
    assert w[resting, 0] == pytest.approx(
        v * (1 - np.exp(-1 / tau)) * np.exp(-(time[resting] - 1) / tau), abs=3e-3
    )
    assert not law[resting].any()


def test_friction_behind_a_play_waits_until_the_play_is_crossed(bench):
    """From the middle: free for g, built up some lengths s later; free for 2 g after the turn."""
    g, s, f_c, speed = 0.02, 1e-3, 5.0, 0.1
    effect = bench("friction_behind_play", g=g, s=s, f_c=f_c, width=1e-6)
    turn = 1.0
    time = np.linspace(0, 2, 2001)
    law, _ = effect.run(lambda t: {"velocity": speed if t < turn else -speed}, time)
    there, back = speed * time, speed * (time - turn)
    assert np.abs(law[there < 0.95 * g]).max() < 0.01 * f_c
    settled = (there > g + 10 * s) & (time < turn)
    assert law[settled] == pytest.approx(f_c, rel=1e-3)
    free = (back > 1.1 * s) & (back < 2 * g)
    assert free.sum() > 300
    assert np.abs(law[free]).max() < 0.02 * f_c
    assert law[back > 2 * g + 12 * s] == pytest.approx(-f_c, rel=1e-3)


def test_swings_within_the_play_meet_no_friction(bench):
    effect = bench("friction_behind_play", g=0.02, s=1e-3, f_c=5.0, width=1e-6)
    law, _ = effect.run(lambda t: {"velocity": 0.015 * 6 * np.cos(6 * t)}, np.linspace(0, 4, 801))
    assert np.abs(law).max() < 0.01 * 5.0


@pytest.mark.parametrize("drive_side", ["input_saturation", "input_gain"])
def test_a_loss_at_the_load_and_one_of_the_drive_name_each_other(drive_side):
    for name in ("load_friction", "two_sided_load_friction"):
        assert drive_side in effect_named(name).look_alikes
        assert name in effect_named(drive_side).look_alikes
