"""The truth of the virtual EMPS against scipy with events, against its energy, and against a finer step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hybridid.rigs.emps import DEFAULT, EMPSConfig, EMPSRig, EMPSTruth
from hybridid.rigs.laws import Law
from hybridid.rigs.machine import Motion
from hybridid.rigs.truth import PlantedAt, at

DT = 1e-3
M, F_V, F_C, OFFSET = 95.0, 203.0, 20.4, -3.2
PEAK, V_S, K_3, DRAG = 6.0, 0.008, 4000.0, 300.0
RICH = EMPSTruth(
    planted=(
        at("carriage", "stribeck", amplitude=PEAK, velocity=V_S),
        at("carriage", "cubic_stiffness", k_3=K_3, q_0=0.1),
        at("carriage", "quadratic_drag", c=DRAG),
    )
)


def replay(machine, force, **settings):
    """Positions (n,) and velocities (n,) under a recorded force, without the loop."""
    motion = Motion(machine, [0.0], **settings)
    q, v = [0.0], [0.0]
    for k in range(len(force) - 1):
        motion.advance(DT, force[k : k + 1])
        q.append(motion.positions[0])
        v.append(motion.velocities[0])
    return np.array(q), np.array(v), motion


def resistance(q, v, s):
    stribeck = s * PEAK * np.exp(-((v / V_S) ** 2))
    return F_V * v + s * F_C + OFFSET + stribeck + K_3 * (q - 0.1) ** 3 + s * DRAG * v**2


def scipy_slide(q, v, s, force, duration):
    """Sliding one way with solve_ivp, stopped at a standstill."""

    def stop(t, y):
        return y[1] if t > 1e-12 else s

    stop.terminal, stop.direction = True, -s
    return solve_ivp(
        lambda t, y: [y[1], (force - resistance(y[0], y[1], s)) / M],
        (0.0, duration),
        [q, v],
        method="DOP853",
        events=stop,
        rtol=1e-11,
        atol=1e-14,
    )


def scipy_hold(q, v, s, force):
    """One hold interval with solve_ivp, stopped at each standstill; returns (q, v, s) at its end."""
    t = 0.0
    while t < DT:
        if s == 0:
            up, down = resistance(q, 0.0, 1), resistance(q, 0.0, -1)
            s = 1 if force > up else -1 if force < down else 0
        if s == 0:
            return q, 0.0, 0

        part = scipy_slide(q, v, s, force, DT - t)
        t, (q, v) = t + part.t[-1], part.y[:, -1]
        if part.status == 1:
            v, s = 0.0, 0
    return q, v, s


def test_it_agrees_with_scipy_and_its_events_on_a_second_with_sticking_and_a_turn():
    force = EMPSRig(EMPSConfig(truth=RICH)).experiment(duration=1.2).inputs["force"]
    mine, speed, motion = replay(RICH.machine, force)
    q, v, s, theirs, stuck = 0.0, 0.0, 0, [0.0], 0
    for held in force[:-1]:
        q, v, s = scipy_hold(q, v, s, held)
        theirs.append(q)
        stuck += s == 0
    assert stuck > 100
    assert motion.events >= 2
    assert {-1, 1} <= set(np.sign(speed))
    assert np.abs(mine - theirs).max() < 1e-12


def test_halving_the_step_and_tightening_the_tolerance_change_nothing_that_a_sensor_could_see():
    truth = replace(
        RICH,
        planted=(
            *RICH.planted,
            at("carriage", "dahl", amplitude=4.0, stiffness=2e5),
            at("carriage", "flexible_mode", mass=8.0, frequency=40.0, damping=0.01),
        ),
    )
    force = EMPSRig(EMPSConfig(truth=truth)).experiment("validation", duration=3.0).inputs["force"]
    normal, _, _ = replay(truth.machine, force)
    halved, _, _ = replay(truth.machine, force, max_step=DT / 2)
    tight, _, _ = replay(truth.machine, force, tolerance=1e-12)
    assert np.abs(normal - halved).max() < 1e-9
    assert np.abs(normal - tight).max() < 1e-9


def _meter(t, q, v, s, z, p, dz):
    """Power [W] that the irreversible laws take; exerts nothing."""
    dz[0] = F_V * v * v + F_C * s * v + DRAG * s * v**3 + PEAK * s * v * np.exp(-((v / V_S) ** 2))
    return 0.0


def test_the_work_of_the_drive_is_found_again_as_heat_spring_and_motion():
    meter = Law("meter", "z' = power of the friction, F = 0", _meter, (("scale", ""),), states=1)
    truth = replace(RICH, planted=(*RICH.planted, PlantedAt("carriage", meter(scale=1.0))))
    force = EMPSRig(EMPSConfig(truth=truth)).experiment("validation", duration=4.0).inputs["force"]
    q, v, motion = replay(truth.machine, force)
    work = np.sum(force[:-1] * np.diff(q))
    stored = 0.5 * M * v[-1] ** 2 + OFFSET * q[-1] + 0.25 * K_3 * ((q[-1] - 0.1) ** 4 - 0.1**4)
    heat = motion.law_states[0]
    assert heat > 5.0
    assert work == pytest.approx(stored + heat, rel=1e-8)


def test_the_default_truth_is_the_published_machine_by_direction():
    """Janot, Gautier, Brunot (2019), Section 4.2: Fv+ 166.7061, Fc+ 20.1440, Fv- 240.4236, Fc- 20.6277."""
    truth = DEFAULT.truth
    (worn,) = truth.planted
    (difference,) = dict(worn.what.values).values()
    assert worn.what.law.name == "asymmetric_viscous"
    assert (truth.f_v - difference / 2, truth.f_v + difference / 2) == pytest.approx(
        (166.706, 240.424), abs=1e-3
    )
    assert (truth.offset + truth.f_c, truth.offset - truth.f_c) == pytest.approx((20.144, -20.628), abs=1e-3)
    assert truth.M == 95.154


def test_a_symmetric_fit_of_the_default_machine_finds_the_published_offset():
    """Where direction is left out, its mean over the strokes turns up as offset: -3.16 N on the machine."""
    made = EMPSRig().experiment()
    q, v, force = made.truth["position"], made.truth["velocity"], made.inputs["force"][:-1]
    s = np.sign(v[:-1])
    columns = np.column_stack([np.diff(v), np.diff(q), s * DT, np.full_like(s, DT)])[s != 0]
    estimate = np.linalg.lstsq(columns, force[s != 0] * DT, rcond=None)[0]
    assert estimate == pytest.approx([95.1089, 203.5034, 20.3935, -3.1648], rel=0.07)
