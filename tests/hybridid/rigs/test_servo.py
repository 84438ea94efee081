"""The virtual servo: its goals, its motor, its truth against scipy, and a fit that finds it again."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hybridid.estimators import fit
from hybridid.model import compose
from hybridid.plants.servo import Servo
from hybridid.rigs.laws import RigError
from hybridid.rigs.loop import Encoder
from hybridid.rigs.servo import DROP, GAINS, GOALS, ServoConfig, ServoRig, ServoTruth
from hybridid.rigs.truth import at
from hybridid.settings.fit import FitSettings

COUNT = 2 * math.pi / 4096


def test_a_record_says_that_it_is_simulated_and_of_what():
    record = ServoRig().record("sin_sin_kp400", duration=0.5)
    assert record.simulated
    for part in (
        "simulated",
        "R_s 1 ohm",
        "load_friction at joint (mu 0.2)",
        "coulomb at joint (f_c 0.01 N m)",
    ):
        assert part in record.source
    assert record.input("kp").tolist() == [400.0] * record.n
    np.testing.assert_allclose(record.outputs / COUNT, np.round(record.outputs / COUNT), atol=1e-6)


def test_the_same_seed_repeats_and_another_differs():
    first, again, other = (ServoRig().record("sin_sin_kp100", seed=s, duration=0.3) for s in (1, 1, 2))
    assert np.array_equal(first.outputs, again.outputs)
    assert not np.array_equal(first.outputs, other.outputs)


def test_the_goals_of_the_three_kinds():
    time = np.array([0.0, 1.5, 2.0, 3.0, 6.0])
    quarter = math.pi / 2
    np.testing.assert_allclose(GOALS["up_and_down"](time)[[0, 1, 3, 4]], quarter * np.array([0, 0.5, 1, 0.8]))
    np.testing.assert_allclose(GOALS["lift_and_drop"](time)[[0, 2, 4]], [0, -quarter, -quarter])
    assert GOALS["sin_sin"](time)[1] == pytest.approx(
        quarter * math.sin(1.5) + 0.5 * math.sin(7.5) * math.sin(3)
    )
    assert ServoRig.runs == tuple(f"{kind}_kp{gain}" for kind in GOALS for gain in GAINS)


def test_the_torque_goes_off_at_the_drop_only():
    drop = ServoRig().record("lift_and_drop_kp400", duration=DROP + 0.2)
    np.testing.assert_array_equal(drop.input("enabled"), drop.time < DROP)
    assert ServoRig().record("up_and_down_kp400", duration=0.2).input("enabled").all()


def test_a_damped_pendulum_without_torque_swings_as_scipy_says():
    """After the drop the bridge is open: the weight and the planted damping alone act."""
    truth = ServoTruth(k_t=0.3, R_s=0.0, q_0=0.0, planted=(at("joint", "viscous", f_v=0.004),))
    rig = ServoRig(ServoConfig(truth=truth, encoder=Encoder(resolution=1e-7)))
    made = rig.experiment("lift_and_drop_kp800", duration=4.0)
    after = made.time >= DROP
    start = made.truth["position"][after][0], made.truth["velocity"][after][0]
    inertia, weight = truth.J + truth.m * truth.l**2, truth.m * 9.80665 * truth.l
    known = solve_ivp(
        lambda _, x: (x[1], (-weight * math.sin(x[0]) - 0.004 * x[1]) / inertia),
        (0.0, 2.0),
        start,
        t_eval=made.time[after] - made.time[after][0],
        rtol=1e-10,
        atol=1e-12,
    )
    np.testing.assert_allclose(made.truth["position"][after], known.y[0], atol=1e-5)


def test_load_friction_holds_the_weight_where_the_motor_alone_does_not():
    """At rest |drive + load| <= mu |drive - load|: the bob stops short of where goal and weight agree."""
    truth = ServoTruth(
        q_0=0.0, planted=(at("joint", "load_friction", mu=0.2), at("joint", "viscous", f_v=0.02))
    )
    made = ServoRig(ServoConfig(truth=truth)).experiment("up_and_down_kp200")
    still = (made.time > 3.5) & (np.abs(made.truth["velocity"]) == 0.0)
    assert still.sum() > 50
    k = int(np.flatnonzero(still)[0])
    drive = truth.torque(made.auxiliary["duty"][k], 7.4, 0.0)
    load = -truth.m * 9.80665 * truth.l * math.sin(made.truth["position"][k])
    assert abs(drive + load) <= 0.2 * abs(drive - load) * 1.01
    assert abs(drive + load) > 0.01, "friction carries a part of it"


def test_an_impossible_truth_is_one_line():
    with pytest.raises(RigError, match="R_s 4 ohm not below 0 and below R"):
        ServoRig().with_truth({"R_s": 4.0})
    with pytest.raises(RigError, match=r"rig\.truth"):
        ServoRig().with_truth({"mass": 4.0})


def test_a_fit_finds_the_rigs_numbers_again():
    rig = ServoRig()
    records = [rig.record(run) for run in ("sin_sin_kp200", "sin_sin_kp800", "lift_and_drop_kp400")]
    model = compose(Servo(), ["viscous", "coulomb", "load_friction"])
    values = fit(model, records, FitSettings(initial_state="measured")).values
    assert values["joint.load_friction.mu"] == pytest.approx(0.2, rel=0.05)
    assert values["k_t"] == pytest.approx(0.3, rel=0.03)
    assert values["R_s"] == pytest.approx(1.0, rel=0.1)
    assert values["J"] == pytest.approx(0.0018, rel=0.1)
    assert values["joint.coulomb.f_c"] == pytest.approx(0.01, abs=0.003)
    assert values["q_0"] == pytest.approx(-0.015, abs=0.003)
