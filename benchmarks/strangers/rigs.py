"""Simulated machines that hold more than their template declares: a friction damper behind a gap, on a test
rig, and a pendulum that swings free."""

from __future__ import annotations

import numpy as np

from benchmarks.strangers.recording import Simulated, clock, run, table

GAP, LEVEL, STIFFNESS = 1e-3, 50.0, 2e5  # m, half the gap; N, friction of the damper; N/m, before it slides
MOVED = 0.5  # kg, between specimen and load cell
FINE = 20  # steps a sample of the contact


def gap_damper(seconds: float = 20.0) -> Simulated:
    """A rod with Dahl friction that a pin moves, which has play in its slot. The motion is prescribed.

    The pin pushes and never pulls: where the rod has sprung back and its friction is zero, contact is lost.
    """
    fine, sizes = clock(seconds, 500.0 * FINE), 1e-3 * np.array([4.0, 2.0, 1.2])
    w, phase = 2 * np.pi * np.array([0.31, 0.83, 1.7]), np.array([0.0, 1.0, 2.0])
    angle = w * fine[:, None] + phase
    growing = 0.3 + 0.7 * fine / seconds  # so that the strokes differ
    q = growing * (sizes * np.sin(angle)).sum(axis=1)
    force = _pushed(q)[::FINE] + MOVED * np.gradient(np.gradient(q, fine), fine)[::FINE]
    t, q = fine[::FINE], q[::FINE]
    noise = np.random.default_rng(8).normal(0, [1e-6, 0.1], (len(t), 2))  # 1 µm, 0.1 N
    text = table("time [s],stroke [mm],load cell [N]", t, (q + noise[:, 0]) * 1e3, force + noise[:, 1])
    play = {"specimen.friction_behind_play.g": GAP, "specimen.friction_behind_play.f_c": LEVEL}
    return Simulated(text, {"M": MOVED, **play})


def _pushed(q: np.ndarray) -> np.ndarray:
    """Force of the pin on the rod [N] as it moves through ``q`` (n,) in small steps."""
    rod, friction, found = 0.0, 0.0, np.zeros(len(q))
    for k, pin in enumerate(q):
        if pin - rod > GAP:  # pushes forward
            rod, friction = pin - GAP, _dahl(friction, pin - GAP - rod)
        elif pin - rod < -GAP:  # pushes backward
            rod, friction = pin + GAP, _dahl(friction, pin + GAP - rod)
        elif friction:  # the rod springs back with the pin until nothing bends it
            side = np.sign(friction)
            rest = _dahl(friction, pin - side * GAP - rod)
            rod, friction = (pin - side * GAP, rest) if rest * side > 0 else (rod, 0.0)
        found[k] = friction
    return found


def _dahl(friction: float, step: float) -> float:
    """``dF = σ (1 - F sign(dz)/F_c) dz``, over one step of the rod. Dahl (1968), TOR-0158(3107-18)-1."""
    side = np.sign(step)
    return side * LEVEL + (friction - side * LEVEL) * np.exp(-STIFFNESS * abs(step) / LEVEL)


def free_swing(seconds: float = 20.0, more: tuple[float, ...] = ()) -> Simulated:
    """A pendulum let go at 60°: a bearing with viscous and dry friction, and the drag of the air. It is let
    go once ``more`` at each of these angles in °."""
    truth = {
        "G": 20.0,
        "pivot.viscous.f_v": 0.05,
        "pivot.coulomb.f_c": 0.06,
        "pivot.quadratic_drag.c_d": 0.03,
    }
    first, *others = (_swing(angle, seconds) for angle in (60.0, *more))
    return Simulated(first, truth, more=tuple(others))


def three_swings() -> Simulated:
    """The same pendulum, let go at 60°, 25° and 40°."""
    return free_swing(more=(25.0, 40.0))


def _swing(angle: float, seconds: float) -> str:
    t = clock(seconds)

    def rates(_: float, x: np.ndarray) -> list[float]:
        resisting = 0.05 * x[1] + 0.06 * np.tanh(x[1] / 2e-3) + 0.03 * x[1] * abs(x[1])
        return [x[1], -20.0 * np.sin(x[0]) - resisting]

    q, _ = run(rates, [np.radians(angle), 0.0], t)
    counts = np.round(q / (2 * np.pi) * 16384)  # of the encoder
    return table("time [s],angle [deg]", t, counts * 360 / 16384)
