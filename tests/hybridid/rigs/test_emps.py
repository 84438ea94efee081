"""The virtual EMPS: what it records, that it repeats, and that its planted effects are in it."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from hybridid.rigs.emps import DEFAULT, EMPSConfig, EMPSRig, EMPSTruth, SquareWave
from hybridid.rigs.law_library import plant
from hybridid.rigs.laws import RigError
from hybridid.rigs.loop import Drive, Encoder
from hybridid.rigs.truth import PlantedAt

SHORT = 3.0
GAIN, KP, KV, DT = 35.15, 160.18, 243.45, 1e-3
PLANTED = (
    plant("asymmetric_viscous", difference=73.7),
    plant("asymmetric_coulomb", difference=4.0),
    plant("stribeck", amplitude=5.0, velocity=0.01),
    plant("quadratic_drag", c=400.0),
    plant("cubic_stiffness", k_3=4000.0, q_0=0.1),
    plant("stiffness", k=40.0, q_0=0.1),
    plant("cogging", amplitude=2.0, pitch=0.005, phase=0.0),
    plant("position_friction", slope=40.0, q_0=0.0),
    plant("friction_drift", rate=1.0),
    plant("dahl", amplitude=5.0, stiffness=2e5),
    plant("flexible_mode", mass=10.0, frequency=30.0, damping=0.02),
)


def rig_with(*planted, **truth):
    return EMPSRig(
        EMPSConfig(truth=EMPSTruth(planted=tuple(PlantedAt("carriage", one) for one in planted), **truth))
    )


@pytest.fixture(scope="module")
def plain():
    """What a symmetric machine does in three seconds."""
    return rig_with().experiment(duration=SHORT)


def test_a_record_says_that_it_is_simulated_and_of_what():
    record = EMPSRig().record(duration=SHORT)
    assert record.simulated
    assert record.provenance == "simulated"
    assert "simulated" in record.source
    assert "M 95.154 kg" in record.source
    assert "asymmetric_viscous at carriage (difference 73.718 N s/m)" in record.source
    assert record.n == 3001
    assert record.dt == pytest.approx(1e-3)
    channels = (*record.input_channels, *record.output_channels, *record.auxiliary_channels)
    assert [(c.name, c.unit) for c in channels] == [
        ("force", "N"), ("position", "m"), ("reference", "m"), ("pulses", "V")
    ]  # fmt: skip
    assert record.input_channels[0].hold == "zoh"
    assert record.warnings == ()


def test_the_same_seed_repeats_and_another_draws_other_noise():
    rig = EMPSRig()
    first, again, other = (rig.record(seed=seed, duration=SHORT) for seed in (3, 3, 4))
    assert np.array_equal(first.outputs, again.outputs)
    assert np.array_equal(first.inputs, again.inputs)
    assert first.digest == again.digest != other.digest
    assert not np.array_equal(first.outputs, other.outputs)
    assert np.abs(first.outputs - other.outputs).max() < 1e-6
    assert np.array_equal(rig.record(seed=3, duration=2.0).outputs, first.outputs[:2001])


def test_the_digest_follows_everything_that_decides_the_record():
    digests = {
        EMPSRig().digest(),
        EMPSRig().digest("validation"),
        EMPSRig().digest(seed=1),
        EMPSRig().digest(duration=3.0),
        rig_with().digest(),
        rig_with(M=96.0).digest(),
        rig_with(plant("asymmetric_viscous", difference=73.8)).digest(),
        EMPSRig(replace(DEFAULT, encoder=Encoder(5e-8, 2e-8))).digest(),
        EMPSRig(replace(DEFAULT, pulses=SquareWave(height=4.0))).digest(),
    }
    assert len(digests) == 9
    assert EMPSRig().digest() == EMPSRig(EMPSConfig(truth=DEFAULT.truth)).digest()


def test_the_encoder_counts_in_its_resolution(plain):
    counts = plain.outputs["position"] / 5e-8
    assert np.abs(counts - np.round(counts)).max() < 1e-6
    error = plain.outputs["position"] - plain.truth["position"]
    assert error.std() == pytest.approx(np.hypot(5e-8 / np.sqrt(12), 1e-8), rel=0.1)


@pytest.mark.parametrize(("run", "height"), [("identification", 0.0), ("validation", 5.0)])
def test_force_is_the_control_law_on_the_position_of_its_own_sample(run, height):
    record = EMPSRig().record(run, duration=SHORT)
    q = record.output("position")
    filtered = 0.5 * (q + np.concatenate([[q[0]], q[:-1]]))
    velocity = np.diff(filtered, prepend=filtered[0]) / DT
    command = KP * KV * (record.auxiliary[:, 0] - q) - KV * velocity
    pulses = height * (np.arange(record.n) // 500 % 2)
    assert record.input("force") == pytest.approx(GAIN * np.clip(command + pulses, -10, 10), abs=1e-6)


def test_the_drive_saturates():
    weak = EMPSRig(replace(DEFAULT, drive=Drive(gain=GAIN, saturation=2.0)))
    force = weak.record(duration=SHORT).input("force")
    assert np.abs(force).max() == pytest.approx(2.0 * GAIN)


def test_it_stays_put_until_it_is_told_to_move(plain):
    waits = plain.auxiliary["reference"] == 0
    start = np.flatnonzero(~waits)[0]
    assert start == 101
    assert not plain.truth["position"][:start].any()
    assert not plain.truth["velocity"][:start].any()


def test_between_events_its_motion_obeys_the_equation_of_motion_with_the_true_parameters():
    """Integrated over one hold: M dv = force dt - f_v dq - f_c s dt - offset dt + (difference / 2) |dq|."""
    made = EMPSRig().experiment("validation", duration=8.0)
    q, v, force = made.truth["position"], made.truth["velocity"], made.inputs["force"][:-1]
    dq, dv, s = np.diff(q), np.diff(v), np.sign(v[:-1])
    slides = (s != 0) & (np.sign(v[1:]) == s)
    columns = np.column_stack([dv, dq, s * DT, np.full_like(s, DT), -0.5 * s * dq])[slides]
    estimate = np.linalg.lstsq(columns, force[slides] * DT, rcond=None)[0]
    assert estimate == pytest.approx([95.154, 203.565, 20.386, -0.242, 73.718], rel=1e-6)


@pytest.mark.parametrize("planted", PLANTED, ids=lambda planted: planted.law.name)
def test_a_planted_effect_is_in_the_record(planted, plain):
    made = rig_with(planted).experiment(duration=SHORT)
    changed = made.inputs["force"] - plain.inputs["force"]
    assert changed.std() > 0.2
    assert np.abs(made.outputs["position"] - plain.outputs["position"]).max() > 20 * 5e-8
    # the loop still follows its reference
    assert np.abs(made.auxiliary["reference"] - made.outputs["position"]).max() < 2e-3


@pytest.mark.parametrize("planted", PLANTED, ids=lambda planted: planted.law.name)
def test_an_effect_of_hardly_any_amplitude_is_hardly_there(planted, plain):
    values = dict(planted.values)
    values[planted.law.parameters[0][0]] *= 1e-6
    values.update({"stiffness": 0.2} if planted.law.name == "dahl" else {})
    made = rig_with(plant(planted.law.name, **values)).experiment(duration=SHORT)
    assert np.abs(made.truth["position"] - plain.truth["position"]).max() < 1e-6


def test_asymmetric_coulomb_friction_is_an_offset_in_motion_and_at_rest():
    """Dry friction that differs by direction shifts its whole interval: no experiment tells the two apart."""
    by_direction = rig_with(plant("asymmetric_coulomb", difference=4.0), offset=-3.2)
    as_offset = rig_with(offset=-5.2)
    first, second = (rig.experiment("validation", duration=SHORT) for rig in (by_direction, as_offset))
    assert first.truth["position"] == pytest.approx(second.truth["position"], abs=1e-9)


def test_effects_add_up_in_one_truth():
    both = rig_with(PLANTED[2], PLANTED[10]).experiment(duration=1.0)
    alone = rig_with(PLANTED[2]).experiment(duration=1.0)
    assert np.abs(both.truth["position"] - alone.truth["position"]).max() > 1e-6


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: EMPSRig().record("validate"), "rig emps: no run 'validate'; nearest: validation"),
        (lambda: EMPSRig().record(seed=-1), "seed is -1, must be a whole number, 0 or more"),
        (lambda: EMPSRig().record(duration=0.0), "duration is 0 s, must be 0.01 s or more"),
        (lambda: EMPSRig().record(duration=float("nan")), "duration is nan s"),
        (lambda: EMPSTruth(M=0.0), "M is 0 kg"),
        (lambda: SquareWave(samples=0), "samples must be 1 or more"),
    ],
)
def test_a_rig_that_cannot_be_run_says_why_in_one_line(make, said):
    with pytest.raises(RigError, match=said) as refused:
        make()
    assert "\n" not in str(refused.value)


def test_the_whole_record_is_long_enough_and_cheap():
    EMPSRig().record(duration=0.01)
    start = time.process_time()
    record = EMPSRig().record()
    assert time.process_time() - start < 2.0
    assert record.n == 24_841
    assert record.time[-1] == pytest.approx(24.84)


@pytest.mark.parametrize(
    ("file", "run"), [("DATA_EMPS.mat", "identification"), ("DATA_EMPS_PULSES.mat", "validation")]
)
def test_the_rig_is_driven_and_follows_like_the_measured_machine(measured, file, run):
    from pymatreader import read_mat

    data = read_mat(measured / "emps" / file)
    real_force, real_error = data["gtau"] * data["vir"].ravel(), (data["qg"] - data["qm"]).ravel()
    record = EMPSRig().record(run)
    force, error = record.input("force"), record.auxiliary[:, 0] - record.output("position")
    for mine, real, within in (
        (force.std(), real_force.std(), 0.2),
        (np.abs(force).max(), np.abs(real_force).max(), 0.1),
        (np.sqrt((error**2).mean()), np.sqrt((real_error**2).mean()), 0.1),
        (np.abs(error).max(), np.abs(real_error).max(), 0.1),
    ):
        assert mine == pytest.approx(real, rel=within)
