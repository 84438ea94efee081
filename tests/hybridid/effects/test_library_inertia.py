"""Inertias that vary against Lagrange's equation, and found again by a fit."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.estimators import FitSettings, fit
from hybridid.model import Model, Term, compose
from hybridid.plants.servo import Servo
from hybridid.records.record import Channel, Record
from hybridid.simulation import simulate

KNOWN = {"J": 2e-3, "k_t": 0.35, "R_s": 0.5, "q_0": 0.0, "joint.viscous.f_v": 0.01}
DT, N = 0.01, 600


def inertia(effect, q: float) -> float:
    """m(q), which is the effort at rest over the acceleration."""
    return effect.law(position=q, acceleration=1.0)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("varying_inertia", {"m_1": 3.0, "m_2": -2.0, "q_0": 0.4}),
        ("cyclic_inertia", {"m_c": 0.7, "m_s": -0.3, "n": 1.0}),
        ("cyclic_inertia", {"m_c": 0.7, "m_s": -0.3, "n": 2.0}),
    ],
)
def test_the_effort_is_lagranges(bench, name, values):
    """F = d/dt (m v) - ½ m' v², with m' by differences."""
    effect, rng, step = bench(name, **values), np.random.default_rng(1), 1e-6
    for _ in range(10):
        q, v, a = rng.normal(size=3)
        slope = (inertia(effect, q + step) - inertia(effect, q - step)) / (2 * step)
        wanted = inertia(effect, q) * a + slope * v**2 - 0.5 * slope * v**2
        assert effect.law(position=q, velocity=v, acceleration=a) == pytest.approx(wanted, rel=1e-6, abs=1e-8)


def test_an_arm_that_extends_is_heavier_by_its_square(bench):
    arm = bench("varying_inertia", m_1=0.0, m_2=5.0)
    assert inertia(arm, 0.3) == pytest.approx(5.0 * 0.09)
    assert bench("cyclic_inertia", m_c=2.0, m_s=0.0, n=2.0).law(position=np.pi, acceleration=1.0) == 2.0


def turning(model: Model, values: dict[str, float]) -> Record:
    """A pendulum that a servo swings to and fro by more than half a turn, simulated."""
    t = DT * np.arange(N)
    goal = 4.5 * np.sin(2 * np.pi * 0.4 * t) * (t > 0.1)
    inputs = np.column_stack([goal, np.full(N, 400.0), np.full(N, 5.0), np.ones(N)])
    channels = tuple(Channel(s.name, s.unit, "zoh") for s in model.inputs), (Channel("position", "rad"),)
    blank = Record("swing", t, inputs, np.sin(t)[:, None], *channels, simulated=True)
    shown = simulate(model, values, blank, np.zeros(2), substeps=4).outputs
    assert np.ptp(shown) > np.pi
    return Record("swing", t, inputs, shown, *channels, simulated=True)


@pytest.mark.parametrize(("m_c", "m_s"), [(0.0, 0.0), (-4e-3, 0.0), (0.0, 4e-3)])
def test_a_fit_finds_it_from_starts_with_little_inertia_left(m_c, m_s):
    """Of the 6.9 g m² of the pendulum, 2.9 are left at one angle."""
    fixed = {name: {"fixed": value} for name, value in KNOWN.items()}
    model = compose(Servo(), ["viscous", "cyclic_inertia"], fixed)
    name = Term(effect_named("cyclic_inertia"), "joint").name
    truth = {f"{name}.m_c": 1.5e-3, f"{name}.m_s": -1e-3}
    settings = FitSettings(start="guess", continuation=(1.0,), horizon=50, substeps=4)
    start = {f"{name}.m_c": m_c, f"{name}.m_s": m_s}
    found = fit(model, [turning(model, truth)], settings, start_values=start)
    for parameter, value in truth.items():
        assert found.values[parameter] == pytest.approx(value, rel=0.02)
