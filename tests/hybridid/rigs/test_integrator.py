"""The truth's integrator against closed forms: dry friction that stops, sticks and lets go where it must."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.rigs.law_library import (
    ASYMMETRIC_VISCOUS,
    COULOMB,
    CUBIC_STIFFNESS,
    DAHL,
    FLEXIBLE_MODE,
    LOAD_FRICTION,
    OFFSET,
    POSITION_FRICTION,
    STIFFNESS,
    STRIBECK,
    VISCOUS,
    WEIGHT,
)
from hybridid.rigs.laws import Law, RigError
from hybridid.rigs.machine import Machine, Motion

NONE = np.zeros(1)


def carriage(*laws, mass=2.0):
    return Machine(((mass,),), ((1.0,),), ((1.0,),), (laws,))


def push(force):
    return np.array([float(force)])


def test_viscous_carriage_follows_its_exponential():
    mass, f_v, force = 2.0, 5.0, 3.0
    motion = Motion(carriage(VISCOUS(f_v=f_v), mass=mass), [0.0])
    for _ in range(100):
        motion.advance(0.01, push(force))
    assert motion.velocities[0] == pytest.approx(force / f_v * (1 - np.exp(-f_v / mass)), rel=1e-10)


def test_coulomb_oscillator_loses_the_same_length_every_half_swing_and_sticks():
    """Half swing j ends at rest at (-1)^j (q_0 - 2 j f_c / k), at t = j pi sqrt(m / k)."""
    mass, k, f_c, start = 2.0, 50.0, 4.0, 0.5
    half = np.pi * np.sqrt(mass / k)
    motion = Motion(carriage(STIFFNESS(k=k, q_0=0.0), COULOMB(f_c=f_c), mass=mass), [start])
    for j in (1, 2):
        motion.advance(half, NONE)
        assert motion.positions[0] == pytest.approx((-1) ** j * (start - 2 * j * f_c / k), abs=1e-9)
    # |q| = 0.18 > f_c / k = 0.08: one more half swing, to |q| = 0.02, where the spring cannot pull it loose
    motion.advance(3 * half, NONE)
    rest = motion.positions[0]
    assert rest == pytest.approx(-(start - 6 * f_c / k), abs=1e-9)
    assert motion.slip[0] == 0
    motion.advance(100.0, NONE)
    assert motion.positions[0] == rest


@pytest.mark.parametrize("sign", [1, -1])
def test_it_sticks_without_creep_below_the_limit_and_lets_go_above(sign):
    mass, f_c, offset = 95.0, 20.4, -3.2
    machine = carriage(COULOMB(f_c=f_c), OFFSET(offset=offset), VISCOUS(f_v=203.0), mass=mass)
    limit = offset + sign * f_c
    motion = Motion(machine, [0.1])
    for _ in range(1000):
        motion.advance(0.01, push(limit - sign * 1e-6))
    assert motion.positions[0] == 0.1
    assert motion.velocities[0] == 0
    assert motion.events == 0
    motion.advance(1e-3, push(limit + sign * 1.0))
    assert motion.slip[0] == sign
    assert motion.positions[0] - 0.1 == pytest.approx(sign * 0.5 / mass * 1e-6, rel=1e-2)


def test_breakaway_takes_the_whole_stribeck_peak_and_the_friction_of_the_place():
    machine = carriage(
        COULOMB(f_c=10.0), STRIBECK(amplitude=5.0, velocity=0.01), POSITION_FRICTION(slope=20.0, q_0=0.0)
    )
    for force, moves in ((16.999, False), (17.001, True), (-16.999, False), (-17.001, True)):
        motion = Motion(machine, [0.1])
        motion.advance(0.1, push(force))
        assert (motion.positions[0] != 0.1) == moves


def test_a_contact_without_dry_friction_turns_round_and_takes_the_other_side_of_its_law():
    """f_v is 1 one way and 3 the other: 1.5 s up, then the turn, then the other time constant."""
    motion = Motion(carriage(VISCOUS(f_v=2.0), ASYMMETRIC_VISCOUS(difference=2.0), mass=1.0), [0.0])
    motion.advance(1.5, push(1.0))
    speed = 1 - np.exp(-1.5)
    assert motion.velocities[0] == pytest.approx(speed, rel=1e-9)
    turn = np.log(1 + speed)
    motion.advance(turn + 0.7, push(-1.0))
    assert motion.velocities[0] == pytest.approx(-(1 - np.exp(-3 * 0.7)) / 3, rel=1e-8)
    assert motion.slip[0] == -1


def test_dahl_friction_is_its_closed_form_in_the_displacement():
    amplitude, stiffness = 15.0, 2e4
    machine = carriage(DAHL(amplitude=amplitude, stiffness=stiffness), VISCOUS(f_v=50.0))
    motion = Motion(machine, [0.0])
    for _ in range(30):
        motion.advance(1e-3, push(40.0))
        expected = 1 - np.exp(-stiffness * motion.positions[0] / amplitude)
        assert motion.law_states[0] == pytest.approx(expected, rel=1e-7)
    assert expected > 0.9


def test_an_appended_mass_keeps_the_momentum_and_swings_at_the_frequency_of_the_pair():
    mass, appended, frequency = 3.0, 1.0, 10.0
    law = FLEXIBLE_MODE(mass=appended, frequency=frequency, damping=0.0)
    motion = Motion(carriage(law, mass=mass), [0.0])
    omega = 2 * np.pi * frequency * np.sqrt(1 + appended / mass)
    for k in range(1, 201):
        motion.advance(1e-3, push(8.0))
        deflection, speed = motion.law_states
        assert mass * motion.velocities[0] + appended * speed == pytest.approx(8.0 * k * 1e-3, rel=1e-9)
        # relative motion: d'' = -omega^2 d - force / mass, from rest
        assert deflection == pytest.approx(-8.0 / mass / omega**2 * (1 - np.cos(omega * k * 1e-3)), abs=1e-10)


def test_two_masses_held_together_by_friction_move_as_one_until_it_slips():
    """Mass 2 is carried by mass 1: it needs m2 a, and friction gives at most f_c."""
    m1, m2, f_c = 2.0, 1.0, 4.0
    machine = Machine(((m1, 0.0), (0.0, m2)), ((1.0,), (0.0,)), ((1.0, -1.0),), ((COULOMB(f_c=f_c),),))
    limit = f_c * (m1 + m2) / m2
    together = Motion(machine, [0.0, 0.0])
    together.advance(1.0, push(limit - 0.01))
    assert together.positions == pytest.approx([0.5 * (limit - 0.01) / (m1 + m2)] * 2, rel=1e-10)
    apart = Motion(machine, [0.0, 0.0])
    apart.advance(1.0, push(limit + 3.0))
    assert apart.velocities == pytest.approx([(limit + 3.0 - f_c) / m1, f_c / m2], rel=1e-10)


def test_a_load_behind_a_spring_breaks_loose_when_the_spring_has_wound_up_enough():
    k, f_load = 100.0, 5.0
    machine = Machine(
        ((1.0, 0.0), (0.0, 1.0)),
        ((1.0,), (0.0,)),
        ((1.0, 0.0), (0.0, 1.0), (1.0, -1.0)),
        ((COULOMB(f_c=1.0),), (COULOMB(f_c=f_load),), (STIFFNESS(k=k, q_0=0.0),)),
    )
    motion = Motion(machine, [0.0, 0.0])
    while motion.slip[1] == 0 and motion.time < 1:
        wound = motion.positions[0]
        motion.advance(1e-4, push(4.0))
    # the motor alone: q = (u - f) / k (1 - cos sqrt(k) t); its spring pulls with 5 N at q = 0.05
    assert wound < f_load / k <= motion.positions[0]
    assert motion.time == pytest.approx(np.arccos(1 - f_load / 3.0) / 10, abs=1e-4)


def test_a_mass_on_a_spring_follows_a_ground_that_runs_as_it_is_driven():
    """q'' = w^2 (b - q) with b = r t: q = r (t - sin(w t) / w); the ground feels nothing."""
    mass, k, rate = 2.0, 50.0, 0.3
    machine = Machine(((mass,),), ((),), ((1.0, -1.0),), ((STIFFNESS(k=k, q_0=0.0),),), prescribed=1)
    motion, omega = Motion(machine, [0.0, 0.0]), np.sqrt(k / mass)
    for j in range(100):
        t = 0.01 * j
        assert motion.positions == pytest.approx([rate * (t - np.sin(omega * t) / omega), rate * t], abs=1e-9)
        motion.drive([rate * t], [rate])
        motion.advance(0.01, np.empty(0))


def test_a_driven_contact_turns_round_as_its_ground_does():
    """A massless side: friction 1 one way and 3 the other, on a mass too heavy to be moved."""
    laws = (VISCOUS(f_v=2.0), ASYMMETRIC_VISCOUS(difference=2.0))
    machine = Machine(((1e9,),), ((),), ((1.0, -1.0),), (laws,), prescribed=1)
    motion = Motion(machine, [0.0, 0.0])
    for rate, f_v in ((1.0, 3.0), (-1.0, 1.0), (2.0, 3.0)):
        before = motion.velocities[0]
        motion.drive([motion.positions[1]], [rate])
        assert motion.slip[0] == -np.sign(rate)
        motion.advance(0.5, np.empty(0))
        assert motion.velocities[0] - before == pytest.approx(f_v * rate * 0.5 / 1e9, rel=1e-6)


def test_halving_the_step_gains_the_order_of_the_method_across_stops_and_turns():
    machine = carriage(CUBIC_STIFFNESS(k_3=400.0, q_0=0.0), COULOMB(f_c=0.5), VISCOUS(f_v=0.2))

    def end(max_step, tolerance=1e9):
        motion = Motion(machine, [1.0], tolerance=tolerance, max_step=max_step)
        motion.advance(1.2, NONE)
        assert motion.events >= 3
        return motion.positions[0]

    exact = end(1e-3, tolerance=1e-13)
    coarse, fine = (abs(end(step) - exact) for step in (0.02, 0.01))
    assert coarse > 1e-9
    assert coarse / fine > 2**4.5
    assert abs(end(np.inf, tolerance=1e-9) - exact) < 1e-8


def test_a_user_law_with_a_state_works_like_those_of_the_library():
    law = Law("odometer", "z' = |v|, F = 0", _odometer, (("gain", ""),), states=1)
    motion = Motion(carriage(law(gain=2.0), STIFFNESS(k=50.0, q_0=0.0), mass=2.0), [0.3])
    motion.advance(2 * np.pi * np.sqrt(2.0 / 50.0), NONE)
    assert motion.law_states[0] == pytest.approx(2.0 * 4 * 0.3, rel=1e-8)


def _odometer(t, q, v, s, z, p, dz):
    dz[0] = p[0] * s * v
    return 0.0


def test_a_truth_that_diverges_says_where():
    motion = Motion(carriage(STIFFNESS(k=-1e300, q_0=0.0)), [1.0])
    with pytest.raises(RigError, match="cannot be integrated beyond 0 s"):
        motion.advance(1.0, NONE)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((((0.0,),), ((1.0,),), ((1.0,),), ((),)), "positive definite"),
        ((((1.0,),), ((1.0,), (1.0,)), ((1.0,),), ((),)), "1 masses need"),
        ((((1.0,),), ((1.0,),), ((1.0,),), ((),), 1), "1 prescribed motions need directions of as many"),
        (
            (((1.0,),), ((1.0,),), ((1.0, -1.0),), ((COULOMB(f_c=1.0),),), 1),
            "a contact with a prescribed motion cannot have dry friction",
        ),
        ((((1.0,),), ((1.0,),), ((1.0,),), ()), "1 contacts need"),
        ((((1.0,),), ((1.0,),), ((1.0,), (2.0,)), ((COULOMB(f_c=1.0),),) * 2), "independent directions"),
    ],
)
def test_a_machine_that_makes_no_sense_is_refused(arguments, said):
    with pytest.raises(RigError, match=said):
        Machine(*arguments)


def test_load_friction_takes_its_share_of_the_drive_and_brakes_when_the_drive_does():
    mass, mu = 2.0, 0.1
    motion = Motion(carriage(LOAD_FRICTION(mu=mu), mass=mass), [0.0])
    motion.advance(1.0, push(10.0))
    assert motion.velocities[0] == pytest.approx((1 - mu) * 10.0 / mass, rel=1e-9)
    motion.advance(0.5, push(-5.0))
    assert motion.velocities[0] == pytest.approx(((1 - mu) * 10.0 - (1 + mu) * 5.0 * 0.5) / mass, rel=1e-9)


@pytest.mark.parametrize(("force", "slip"), [(1.21, 0), (1.23, 1), (0.83, 0), (0.81, -1)])
def test_load_friction_holds_a_weight_within_its_cone(force, slip):
    """Weight G against drive u: it rests while |u - G| <= mu (u + G): from (1 - mu)/(1 + mu) to 1 over it."""
    mu = 0.1
    assert (1 + mu) / (1 - mu) == pytest.approx(1.2222, abs=1e-4)
    machine = carriage(LOAD_FRICTION(mu=mu), WEIGHT(amplitude=1.0, q_0=-np.pi / 2))
    motion = Motion(machine, [0.0])
    motion.advance(1e-3, push(force))
    assert motion.slip[0] == slip


def test_a_motor_carries_the_spring_behind_it():
    """Two bodies at rest, the spring between them wound: the motor lets go at |u + load| = mu |u - load|."""
    k, twist, mu = 50.0, 0.1, 0.2
    directions = ((1.0, 0.0), (1.0, -1.0), (0.0, 1.0))
    laws = ((LOAD_FRICTION(mu=mu),), (STIFFNESS(k=k, q_0=0.0),), (COULOMB(f_c=100.0),))
    machine = Machine(((0.5, 0.0), (0.0, 2.0)), ((1.0,), (0.0,)), directions, laws)
    for share, slips in ((0.99, False), (1.01, True)):
        motion = Motion(machine, [twist, 0.0])
        limit = k * twist * (1 + mu) / (1 - mu)
        motion.advance(1e-4, push(share * limit))
        assert (motion.slip[0] != 0) == slips
