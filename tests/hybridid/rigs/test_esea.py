"""The virtual eSEA: its loop, sensors and sweeps, its truth against scipy, and what is planted in it."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import odeint

from hybridid.rigs.esea import (
    AS_DECLARED_COULOMB_STRIBECK,
    AS_DECLARED_DAHL,
    AS_DECLARED_LINEAR,
    AS_DECLARED_LUGRE,
    DEFAULT,
    UNDECLARED,
    ESEAConfig,
    ESEARig,
    ESEATruth,
)
from hybridid.rigs.laws import Law, RigError
from hybridid.rigs.loop import Drive, Encoder
from hybridid.rigs.machine import Motion
from hybridid.rigs.truth import PlantedAt, at

DT, SHORT = 2e-3, 2.0
I_LINK, J_MOTOR, K_E = 0.0014, 0.0001, 8.459  # Table 5.1
COUNT = 2 * np.pi / 8192


@pytest.fixture(scope="module")
def made():
    return ESEARig().experiment(duration=SHORT)


def test_a_record_says_that_it_is_simulated_and_of_what():
    record = ESEARig().record(duration=SHORT)
    assert record.simulated
    assert record.name == "esea_rig_identification"
    for part in (
        "simulated",
        "K_e 8.459 N m/rad",
        "lugre at motor (f_c 0.045 N m",
        "cubic_stiffness at elastomer",
    ):
        assert part in record.source
    assert record.n == 1001
    assert record.dt == pytest.approx(DT)
    names = [(c.name, c.unit) for c in (*record.input_channels, *record.output_channels)]
    assert names == [("torque", "N·m"), ("link_velocity", "rad/s")]
    assert record.input_channels[0].hold == "zoh"
    assert record.warnings == ()


def test_the_same_seed_repeats_a_longer_run_goes_on_and_another_seed_differs():
    first, again, longer = (ESEARig().record(seed=3, duration=d) for d in (1.0, 1.0, SHORT))
    other = ESEARig().record(seed=4, duration=1.0)
    assert np.array_equal(first.outputs, again.outputs)
    assert np.array_equal(first.outputs, longer.outputs[:501])
    assert not np.array_equal(first.outputs, other.outputs)
    assert first.digest == again.digest
    assert (
        len({first.digest, other.digest, longer.digest, AS_DECLARED_DAHL.digest(seed=3, duration=1.0)}) == 4
    )


def test_torque_is_the_control_law_on_the_motor_encoder(made):
    error = made.auxiliary["reference"] - made.auxiliary["motor_angle"]
    command = 3.0 * error + 0.05 * np.diff(error, prepend=0.0) / DT
    assert made.inputs["torque"] == pytest.approx(np.clip(command, -1.99, 1.99), abs=1e-12)
    weak = ESEARig(replace(ESEAConfig(), drive=Drive(gain=1.0, saturation=0.05))).experiment(duration=SHORT)
    assert np.abs(weak.inputs["torque"]).max() == 0.05


def test_encoders_count(made):
    for name in ("motor_angle", "link_angle"):
        counts = made.auxiliary[name] / COUNT
        assert np.abs(counts - np.round(counts)).max() < 1e-6
        error = made.auxiliary[name] - made.truth[name]
        assert error.std() == pytest.approx(np.hypot(COUNT / np.sqrt(12), 2e-4), rel=0.1)
    noise = made.outputs["link_velocity"] - made.truth["link_velocity"]
    assert noise.std() == pytest.approx(0.143, rel=0.1)


def test_the_velocity_is_the_slope_of_the_angle_without_delay_or_bias():
    fine = ESEARig(replace(ESEAConfig(), encoder=Encoder(resolution=1e-10))).experiment(duration=SHORT)
    error = fine.outputs["link_velocity"] - fine.truth["link_velocity"]
    assert np.abs(error).max() < 2e-3 * np.abs(fine.truth["link_velocity"]).max()


def test_the_sweeps_are_the_thesis_ones():
    config = ESEAConfig()
    for sweep, first, last in ((config.identification, 0.1, 5.0), (config.validation, 0.1, 3.5)):
        t = np.arange(0.0, 10.0, 1e-4)
        r = sweep.position(t) / sweep.amplitude
        crossings = t[1:][np.diff(np.sign(r)) != 0]
        frequency = 0.5 / np.diff(crossings)
        middle = 0.5 * (crossings[1:] + crossings[:-1])
        assert frequency == pytest.approx(first + (last - first) * middle / 10.0, rel=0.02)
    assert (
        config.identification.position(np.array([0.1]))[0]
        > 0
        > config.validation.position(np.array([0.1]))[0]
    )
    assert config.identification.amplitude != config.validation.amplitude


def test_the_link_moves_as_much_as_the_tables_imply_within_the_motors_torque_and_quickly():
    """Var = MSE / (1 - R²): 32.9 rad²/s² in Table 5.4, 17.9 from the linear and LuGre rows of Table 5.5."""
    start = time.process_time()
    runs = {run: ESEARig().record(run) for run in ESEARig.runs}
    assert time.process_time() - start < 4.0
    assert runs["identification"].outputs.var() == pytest.approx(32.9, rel=0.1)
    assert runs["validation"].outputs.var() == pytest.approx(17.9, rel=0.1)
    assert all(np.abs(record.inputs).max() < 1.99 for record in runs.values())


def scipy_truth(torque, rates, states, seconds):
    """Link velocity (n,) under ``torque``, held, by LSODA; ``rates(delta', z)`` gives friction and z'."""

    def slope(t, y, u):
        force, z_rate = rates(y[2], y[4:])
        joint = K_E * (y[0] - y[1])
        return [y[2], y[3], (u - joint - force) / J_MOTOR, joint / I_LINK, *z_rate]

    y, out = np.zeros(4 + states), [0.0]
    for u in torque[: round(seconds / DT)]:
        y = odeint(slope, y, (0, DT), (u,), tfirst=True, rtol=1e-10, atol=1e-13)[-1]
        out.append(y[3])
    return np.array(out)


def _lugre(v, z):
    g = 0.045 + 0.015 * np.exp(-(v**2))
    rate = v - 9.0 * abs(v) * z[0] / g
    return 9.0 * z[0] + 0.01 * rate + 0.004 * v, [rate]


@pytest.mark.parametrize(
    ("rig", "rates", "states"),
    [
        (AS_DECLARED_LINEAR, lambda v, z: (0.01 * v, []), 0),
        (AS_DECLARED_DAHL, lambda v, z: (0.045 * z[0], [9.0 / 0.045 * (v - abs(v) * z[0])]), 1),
        (AS_DECLARED_LUGRE, _lugre, 1),
    ],
    ids=["linear", "dahl", "lugre"],
)
def test_the_truth_as_declared_is_the_thesis_equations_by_another_integrator(rig, rates, states):
    made = rig.experiment(duration=0.6)
    theirs = scipy_truth(made.inputs["torque"], rates, states, 0.6)
    assert np.ptp(theirs) > 0.5
    assert made.truth["link_velocity"] == pytest.approx(theirs[: len(made.time)], abs=1e-6)


def test_dry_friction_holds_the_motor_until_the_torque_is_enough():
    made = AS_DECLARED_COULOMB_STRIBECK.experiment(duration=0.2)
    before = np.abs(made.inputs["torque"]) < 0.06
    first = np.flatnonzero(~before)[0]
    assert first > 3
    assert not made.truth["motor_velocity"][:first].any()
    assert made.truth["motor_velocity"][first + 1] != 0


def _meter(t, q, v, s, z, p, dz):
    """Power [W] of a linear damper; exerts nothing."""
    dz[0] = p[0] * v * v
    return 0.0


def test_the_work_of_the_motor_is_found_again_as_heat_twist_and_motion():
    meter = Law("meter", "z' = f_v v^2, F = 0", _meter, (("f_v", "N s/m"),), states=1)
    dampers = {"motor": 0.01, "elastomer": 0.003}
    truth = ESEATruth(
        planted=(
            *(at(port, "viscous", f_v=f_v) for port, f_v in dampers.items()),
            *(PlantedAt(port, meter(f_v=f_v)) for port, f_v in dampers.items()),
            at("elastomer", "cubic_stiffness", k_3=3000.0, q_0=0.0),
        )
    )
    torque = ESEARig().experiment(duration=SHORT).inputs["torque"]
    motion, work = Motion(truth.machine, [0.0, 0.0]), 0.0
    for u in torque:
        before = motion.positions[0]
        motion.advance(DT, np.array([u]))
        work += u * (motion.positions[0] - before)
    twist, (motor, link) = motion.positions[0] - motion.positions[1], motion.velocities
    stored = 0.5 * J_MOTOR * motor**2 + 0.5 * I_LINK * link**2 + 0.5 * K_E * twist**2 + 750.0 * twist**4
    assert motion.law_states.sum() > 0.01
    assert work == pytest.approx(stored + motion.law_states.sum(), rel=1e-6)


@pytest.mark.parametrize("planted", UNDECLARED, ids=lambda one: f"{one.what.law.name} at {one.port}")
def test_each_undeclared_effect_is_in_the_record(planted, made):
    """By more than a count of the motor's encoder, which commands 0.0023 N·m."""
    rest = tuple(one for one in DEFAULT.planted if one != planted)
    without = ESEARig().with_truth({}, rest).experiment(duration=SHORT)
    assert np.abs(made.truth["motor_angle"] - without.truth["motor_angle"]).max() > COUNT


def test_the_shaft_has_what_is_left_of_the_recorded_torque():
    truth = {"torque_gain": 0.5, "torque_offset": 0.02}
    made = AS_DECLARED_LINEAR.with_truth(truth).experiment(duration=0.6)
    theirs = scipy_truth(0.5 * made.inputs["torque"] + 0.02, lambda v, z: (0.01 * v, []), 0, 0.6)
    assert made.truth["link_velocity"] == pytest.approx(theirs[: len(made.time)], abs=1e-6)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: ESEATruth(J=0.0), "J 0 kg m"),
        (lambda: ESEARig().with_truth({"Ke": 9.0}), "unknown value 'Ke': did you mean 'K_e'"),
        (lambda: ESEARig().with_truth({"K_e": "stiff"}), "K_e is 'stiff': expected a number"),
        (
            lambda: ESEATruth(
                planted=tuple(at(p, "coulomb", f_c=1.0) for p in ("motor", "elastomer", "link"))
            ),
            "independent directions",
        ),
        (lambda: ESEARig().record("identify"), "no run 'identify'; nearest: identification"),
    ],
)
def test_a_rig_that_cannot_be_says_why_in_one_line(make, said):
    with pytest.raises(RigError, match=said) as refused:
        make()
    assert "\n" not in str(refused.value)
