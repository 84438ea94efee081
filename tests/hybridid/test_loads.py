"""Ports know their load: every plant's numbers against its equation of motion, and who may use them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from hybridid.effects.dimension import ONE
from hybridid.effects.effect import Effect, EffectParameter
from hybridid.effects.library import effect_named
from hybridid.model import Model, compose
from hybridid.plants.duffing import Duffing
from hybridid.plants.emps import EMPS
from hybridid.plants.esea import ESEA
from hybridid.plants.flexible_link import FlexibleLink
from hybridid.plants.half_car import HalfCar
from hybridid.plants.plant import Load

PLANTS = (Duffing, EMPS, ESEA, FlexibleLink, HalfCar)
SHARE = EffectParameter("share", ONE, "share of what is seen", guess=0.1, nests=True)
LOSS = Effect(
    "loss", "effort", "loss", "F = share (|drive - load| - drive + 2 load)",
    lambda at: at.p.share * (at.carried - at.drive + 2 * at.load),
    "this test", "none", (SHARE,), needs=("load",),
)  # fmt: skip


def numbers(plant, method, *more):
    """Every value that ``method`` gives for random states, inputs and the plant's guesses."""
    generator = np.random.default_rng(3)
    x = SimpleNamespace(**{s.name: generator.normal() * s.scale for s in plant.states})
    u = SimpleNamespace(**{s.name: generator.normal() for s in plant.inputs})
    p = SimpleNamespace(**{q.name: q.guess for q in plant.parameters})
    return getattr(plant, method)(x, u, p, *more)


@pytest.mark.parametrize("plant", PLANTS)
def test_every_effort_port_has_a_load_or_says_why_not(plant):
    for port in plant().equation_ports:
        assert bool(port.knows) != bool(port.no_load), port.name
    assert set(numbers(plant(), "loads")) == {q.name for q in plant().equation_ports if q.knows}


@pytest.mark.parametrize(
    ("plant", "port", "velocity", "inertia"),
    [
        (EMPS, "carriage", "v", "M"),
        (ESEA, "motor", "delta_dot", "J"),
        (ESEA, "link", "theta_dot", "I"),
        (FlexibleLink, "servo", "theta_dot", "J_eq"),
    ],
)
def test_drive_and_load_are_all_that_moves_the_contact(plant, port, velocity, inertia):
    """``M a = drive + load - F``: with the signs declared."""
    machine = plant()
    effort = {q.name: 7.0 if q.name == port else 0.0 for q in machine.equation_ports}
    at = numbers(machine, "loads")[port]
    mass = next(q.guess for q in machine.parameters if q.name == inertia)
    acceleration = numbers(machine, "derivative", effort)[velocity]
    assert mass * acceleration == pytest.approx(at.drive + at.load - 7.0, rel=1e-12)


def test_an_effect_sees_drive_and_load_after_the_effects_on_the_inputs():
    model = compose(ESEA(), ["input_gain", LOSS])
    values = model.values({"torque.input_gain.g": 0.5, "motor.loss.share": 0.1})
    seen = float(model.efforts(0, [0.3, 0.2, 0.05, 0.01], [0.2], values)[0])
    drive, load = 1.5 * 0.2, -8.459 * 0.04
    assert seen == pytest.approx(0.1 * (abs(drive - load) - drive + 2 * load), rel=1e-9)


def test_the_modulus_is_rounded_over_a_hundredth_of_the_effort_scale():
    model = compose(EMPS(), [LOSS])
    values = model.values({"carriage.loss.share": 1.0})
    for force in (0.0, 0.3, 3.0, -20.0):
        carried = float(model.efforts(0, [0.0, 0.1], [force], values)[0]) + force
        assert carried == pytest.approx(force * np.tanh(force / 0.3), abs=1e-12)


def test_an_effect_that_needs_a_load_is_refused_where_there_is_none():
    wants_both = replace(LOSS, needs=("both_sides",))
    assert [q.name for q in ESEA().ports if LOSS.admissible_at(q)] == ["motor", "link"]
    assert [q.name for q in ESEA().ports if wants_both.admissible_at(q)] == ["motor"]
    assert not any(LOSS.admissible_at(q) for q in (*HalfCar().ports, *Duffing().ports))
    with pytest.raises(ValueError, match=r"needs a port that knows its load; link has no load \(a beam"):
        Model(FlexibleLink()).plus(LOSS, "link")
    with pytest.raises(ValueError, match=r"knows its drive and its load; carriage knows drive, load only"):
        Model(EMPS()).plus(wants_both, "carriage")
    with pytest.raises(ValueError, match=r"half_car has no effort port .* needs a port that knows its load"):
        compose(HalfCar(), [LOSS])


def test_loads_that_no_port_declares_are_an_error():
    class Careless(EMPS):
        def loads(self, x, u, p):
            return {"carriage": Load(u.force), "guide": Load(ca.SX(0))}

    with pytest.raises(ValueError, match=r"test_loads.py, line .*, loads: gives unknown port .* 'guide'"):
        Model(Careless(), ()).plus(effect_named("viscous")).f  # noqa: B018
