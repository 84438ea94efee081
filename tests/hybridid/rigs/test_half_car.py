"""The virtual vehicle: road, driver, sensor; its truth against scipy and the plant; what is planted."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete, periodogram

from hybridid.model import compose
from hybridid.plants.half_car import HalfCar
from hybridid.rigs.half_car import AS_DECLARED, BUMP, HalfCarConfig, HalfCarRig
from hybridid.rigs.half_car_truth import DEFAULT, HalfCarTruth
from hybridid.rigs.laws import Law, RigError
from hybridid.rigs.machine import Motion
from hybridid.rigs.truth import PlantedAt, at
from hybridid.simulation.simulate import simulate

DT = 0.01
M_C, L_F, L_R, M_F, M_R = 1250.0, 1.5, 1.6, 30.0, 30.0  # Table 4.1
I_YY, K_F, K_R, C_F, C_R, K_T = 2441.0, 22223.0, 52916.0, 2273.6, 1938.6, 5.2e5  # Table 4.2, and a tyre
COORDINATES = ("z_c", "theta", "z_f", "z_r")
LEVEL = {"lift_off": False, "wander": 0.0, "sag": 0.0}


@pytest.fixture(scope="module")
def declared():
    return AS_DECLARED.experiment()


@pytest.fixture(scope="module")
def whole():
    return HalfCarRig().experiment()


def linear_half_car():
    """x' = A x + B u of Eq. 4-14 from static equilibrium, x = (velocities, z_c, theta, z_f, z_r)."""
    stiffness = np.array(
        [
            [K_F + K_R, K_R * L_R - K_F * L_F, -K_F, -K_R],
            [K_R * L_R - K_F * L_F, K_F * L_F**2 + K_R * L_R**2, K_F * L_F, -K_R * L_R],
            [-K_F, K_F * L_F, K_F + K_T, 0],
            [-K_R, -K_R * L_R, 0, K_R + K_T],
        ]
    )
    damping = np.array(
        [
            [C_F + C_R, C_R * L_R - C_F * L_F, -C_F, -C_R],
            [C_R * L_R - C_F * L_F, C_F * L_F**2 + C_R * L_R**2, C_F * L_F, -C_R * L_R],
            [-C_F, C_F * L_F, C_F, 0],
            [-C_R, -C_R * L_R, 0, C_R],
        ]
    )
    inverse = np.diag(1 / np.array([M_C, I_YY, M_F, M_R]))
    a = np.block([[-inverse @ damping, -inverse @ stiffness], [np.eye(4), np.zeros((4, 4))]])
    b = np.vstack([inverse @ np.array([[0, 0], [0, 0], [K_T, 0], [0, K_T]]), np.zeros((4, 2))])
    return a, b


def test_a_record_says_that_it_is_simulated_and_of_what():
    record = HalfCarRig().record()
    assert record.simulated
    assert record.name == "half_car_rig_identification"
    for part in (
        "simulated",
        "k_f 22223 N/m",
        "coulomb at rear_suspension (f_c 200 N)",
        "speed wanders by 1 %",
    ):
        assert part in record.source
    channels = [(c.name, c.unit) for c in (*record.input_channels, *record.output_channels)]
    outputs = [("vertical_acceleration", "m/s²"), ("pitch_rate", "rad/s")]
    assert channels == [("u_f", "m"), ("u_r", "m"), *outputs]
    assert [c.hold for c in record.input_channels] == ["foh", "foh"]
    assert (record.n, record.dt) == (601, pytest.approx(DT))
    assert record.warnings == ()


def test_the_same_seed_repeats_a_longer_run_goes_on_and_another_seed_differs():
    first, again, longer = (HalfCarRig().record(seed=3, duration=d) for d in (1.0, 1.0, 2.0))
    other = HalfCarRig().record(seed=4, duration=1.0)
    assert np.array_equal(first.outputs, again.outputs)
    assert np.array_equal(first.outputs, longer.outputs[:101])
    assert not np.array_equal(first.outputs, other.outputs)
    runs = {
        record.digest for record in (first, other, longer, HalfCarRig().record("validation", duration=1.0))
    }
    assert first.digest == again.digest
    assert len(runs | {AS_DECLARED.digest(seed=3, duration=1.0)}) == 5


@pytest.mark.parametrize(("run", "speed"), [("identification", 20 / 3.6), ("validation", 15 / 3.6)])
def test_the_road_as_recorded_is_the_bump_at_the_nominal_speed_the_rear_a_wheelbase_later(run, speed):
    made = HalfCarRig().experiment(run)
    t = made.time - 0.3
    front = np.where((t > 0) & (t < 1.8 / speed), 0.12 * np.sin(np.pi * speed * t / 1.8) ** 2, 0.0)
    assert made.inputs["u_f"] == pytest.approx(front, abs=1e-12)
    later = np.interp(made.time - (L_F + L_R) / speed, made.time, front)
    assert made.inputs["u_r"] == pytest.approx(later, abs=2e-3)
    assert made.inputs["u_r"].max() == pytest.approx(BUMP.height, abs=2e-3)


def test_the_driver_is_late_and_the_wheels_follow_the_road_that_is(whole):
    assert np.abs(whole.inputs["u_r"] - whole.truth["u_r"]).max() > 0.01
    speed = whole.truth["speed"] / (20 / 3.6)
    assert 0.85 < speed.min() < 0.97
    assert whole.truth["u_f"].max() == pytest.approx(0.12, abs=1e-3)
    steady = HalfCarRig().with_truth(LEVEL).experiment()
    assert steady.truth["u_f"] == pytest.approx(steady.inputs["u_f"], abs=1e-12)
    assert steady.truth["u_r"] == pytest.approx(steady.inputs["u_r"], abs=1e-12)


def test_the_truth_as_declared_is_equation_4_14_between_straight_lines_of_road(declared):
    """Against the matrix exponential, exact for a linear machine whose inputs run straight."""
    a, b = linear_half_car()
    f, g, c, d, _ = cont2discrete((a, b, np.eye(8), np.zeros((8, 2))), DT, method="foh")
    roads, x, states = np.column_stack([declared.inputs["u_f"], declared.inputs["u_r"]]), np.zeros(8), []
    for u in roads:
        states.append(c @ x + d @ u)
        x = f @ x + g @ u
    theirs = np.array(states)
    assert np.ptp(theirs[:, 0]) > 0.3
    assert declared.truth["vertical_velocity"] == pytest.approx(theirs[:, 0], abs=1e-7)
    assert declared.truth["pitch_rate"] == pytest.approx(theirs[:, 1], abs=1e-7)
    for k, name in enumerate(COORDINATES):
        assert declared.truth[name] == pytest.approx(theirs[:, 4 + k], abs=1e-8)


def test_the_plant_with_the_true_parameters_runs_as_the_truth_as_declared(declared):
    record = AS_DECLARED.record()
    outputs = np.column_stack([declared.truth["vertical_velocity"], declared.truth["pitch_rate"]])
    channels = [
        replace(c, name=s.name, unit=s.unit)
        for c, s in zip(record.output_channels, HalfCar.outputs, strict=True)
    ]
    record = replace(record, outputs=outputs, output_channels=tuple(channels))
    true = {"I_yy": I_YY, "k_f": K_F, "k_r": K_R, "c_f": C_F, "c_r": C_R, "k_t": K_T}
    run = simulate(compose(HalfCar(), []), true, record, initial_state=np.zeros(8), substeps=20)
    assert run.outputs == pytest.approx(outputs, abs=1e-6)


def strut(k, c, k_3, difference):
    knee = 0.05
    return lambda d, v: k * d + k_3 * d**3 + c * v - 0.5 * difference * (np.sqrt(v**2 + knee**2) - knee)


def test_the_rich_truth_is_its_equations_by_another_integrator():
    """Dampers by direction, springs that stiffen, tyres that lift off; dry friction has its own tests."""
    planted = tuple(one for one in DEFAULT.planted if one.what.law.name != "coulomb")
    made = HalfCarRig(
        HalfCarConfig(truth=replace(DEFAULT, road_step=DT, planted=planted, wander=0, sag=0))
    ).experiment()
    front, rear = strut(K_F, C_F, 8e5, 2000.0), strut(K_R, C_R, 1.5e6, 1800.0)
    loads = 9.81 * (M_C * L_R / 3.1 + M_F), 9.81 * (M_C * L_F / 3.1 + M_R)

    def slope(t, y):
        v, q = y[:4], y[4:]
        u = [np.interp(t, made.time, made.inputs[name]) for name in ("u_f", "u_r")]
        f = front(q[2] - q[0] + L_F * q[1], v[2] - v[0] + L_F * v[1])
        r = rear(q[3] - q[0] - L_R * q[1], v[3] - v[0] - L_R * v[1])
        tyres = [max(K_T * (u[0] - q[2]), -loads[0]), max(K_T * (u[1] - q[3]), -loads[1])]
        return [(f + r) / M_C, (L_R * r - L_F * f) / I_YY, (tyres[0] - f) / M_F, (tyres[1] - r) / M_R, *v]

    t = made.time[:151]
    y = solve_ivp(
        slope, (0, t[-1]), np.zeros(8), method="DOP853", t_eval=t, max_step=5e-4, rtol=1e-9, atol=1e-12
    ).y
    flight = (made.truth["z_r"] - made.truth["u_r"])[:151] > loads[1] / K_T
    assert flight.sum() >= 3
    assert made.truth["vertical_velocity"][:151] == pytest.approx(y[0], abs=1e-6)
    assert made.truth["pitch_rate"][:151] == pytest.approx(y[1], abs=1e-6)
    assert made.truth["z_r"][:151] == pytest.approx(y[7], abs=1e-6)


def _heat(t, q, v, s, z, p, dz):
    dz[0] = p[0] * v * v
    return 0.0


def _impulse(t, q, v, s, z, p, dz):
    dz[0] = p[0] * q
    return 0.0


def test_the_work_of_the_road_is_found_again_as_heat_springs_and_motion():
    heat = Law("heat", "z' = c v^2, F = 0", _heat, (("c", "N s/m"),), states=1)
    impulse = Law("impulse", "z' = k q, F = 0", _impulse, (("k", "N/m"),), states=1)
    meters = (
        PlantedAt("front_suspension", heat(c=C_F)),
        PlantedAt("rear_suspension", heat(c=C_R)),
        PlantedAt("front_tyre", impulse(k=K_T)),
        PlantedAt("rear_tyre", impulse(k=K_T)),
    )
    motion, work = Motion(replace(HalfCarTruth(), planted=meters).machine, np.zeros(6)), 0.0
    t = np.arange(0, 1.2, 1e-3)
    road = 0.05 * np.column_stack([np.sin(9 * t) ** 2, np.sin(7 * t) ** 2])
    for here, there in pairwise(road):
        rate, before = (there - here) / 1e-3, motion.law_states
        motion.drive(here, rate)
        motion.advance(1e-3, np.empty(0))
        work += rate @ (motion.law_states - before)[2:]
    q, v, masses = motion.positions, motion.velocities, np.array([M_C, I_YY, M_F, M_R])
    struts = q[2] - q[0] + L_F * q[1], q[3] - q[0] - L_R * q[1]
    springs = K_F * struts[0] ** 2 + K_R * struts[1] ** 2 + K_T * ((q[4] - q[2]) ** 2 + (q[5] - q[3]) ** 2)
    lost = motion.law_states[:2].sum()
    assert lost > 50
    assert work == pytest.approx(lost + 0.5 * springs + 0.5 * masses @ v[:4] ** 2, rel=1e-7)


def test_a_tyre_that_cannot_pull_leaves_the_road():
    held, free = (
        HalfCarRig().with_truth({**LEVEL, "lift_off": lifts}).experiment() for lifts in (False, True)
    )
    gap = [(made.truth["z_r"] - made.truth["u_r"]).max() for made in (held, free)]
    static = DEFAULT.static_loads[1] / K_T
    assert static < gap[0] < gap[1]


def test_the_sensors_have_noise_bias_and_a_running_engine_in_them(declared):
    error = declared.outputs["pitch_rate"] - declared.truth["pitch_rate"]
    frequency, power = periodogram(error, 1 / DT)
    assert frequency[np.argmax(power)] == pytest.approx(30.0, abs=0.2)
    assert error.mean() == pytest.approx(0.004, abs=4e-4)
    assert error.var() == pytest.approx(0.002**2 + 0.01**2 / 2, rel=0.1)
    velocity = np.cumsum(declared.outputs["vertical_acceleration"] - 0.05) * DT
    half_later = 0.5 * (declared.truth["vertical_velocity"][1:] + declared.truth["vertical_velocity"][:-1])
    assert velocity[:-1] == pytest.approx(half_later, abs=0.02)


def test_the_chassis_moves_as_much_as_table_4_3_implies_and_quickly(whole):
    """RMSE / sqrt(1 - R²): 0.174 m/s and 0.147 rad/s, over the 2.6 s of the thesis' figure."""
    assert whole.truth["vertical_velocity"][:261].std() == pytest.approx(0.174, rel=0.05)
    assert whole.truth["pitch_rate"][:261].std() == pytest.approx(0.147, rel=0.05)
    assert abs(whole.truth["vertical_velocity"][-1]) < 5e-3
    start = time.process_time()
    HalfCarRig().record("validation")
    assert time.process_time() - start < 2.0


@pytest.mark.parametrize("planted", DEFAULT.planted, ids=lambda one: f"{one.what.law.name} at {one.port}")
def test_each_undeclared_effect_is_in_the_record(planted, whole):
    rest = tuple(one for one in DEFAULT.planted if one != planted)
    without = HalfCarRig().with_truth({}, rest).experiment()
    assert np.abs(whole.truth["pitch_rate"] - without.truth["pitch_rate"]).max() > 0.01


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: HalfCarTruth(k_t=0.0), "k_t is 0, must be above 0"),
        (lambda: HalfCarTruth(sag=1.5), "wander and sag must be 0 or more"),
        (lambda: HalfCarRig().with_truth({"k_tyre": 3e5}), "unknown value 'k_tyre'"),
        (lambda: HalfCarRig().with_truth({"lift_off": 3.0}), "lift_off is 3.0: expected true or false"),
        (lambda: HalfCarTruth(planted=(at("front_tyre", "coulomb", f_c=5.0),)), "cannot have dry friction"),
        (lambda: HalfCarRig().record("fast"), "no run 'fast'; allowed: identification, validation"),
    ],
)
def test_a_rig_that_cannot_be_says_why_in_one_line(make, said):
    with pytest.raises(RigError, match=said) as refused:
        make()
    assert "\n" not in str(refused.value)
