"""What is tried in place of a record as it is. All simulated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.torture.pendulum import Pendulum
from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.plants.plant import Motion, Plant
from hybridid.quality import judge
from hybridid.quality.hypotheses import hypotheses
from hybridid.records.record import Channel, Record
from hybridid.signals.steps import apply_steps

DT, N, HORIZON = 0.02, 650, 40
ANGLE = {"step": "integrate", "signal": "speed", "name": "angle", "unit": "rad", "role": "input"}


class Spindle(Plant):
    """``J w' = torque - F``, with the angle turned as an input, as the template of that name has it."""

    name, meaning, source = "spindle", "a spindle", "a test"
    states = (State("w", "rad/s", scale=20.0, observed_by="speed", derivative=0),)
    inputs = (Signal("torque", "N·m"), Signal("angle", "rad"))
    outputs = (Signal("speed", "rad/s"),)
    parameters = (Parameter("J", "kg·m²", 0.4, 0.004, 40.0),)
    ports = (Port("bearing", "effort", "N·m", 2.0, "rad", 20.0, 20.0, 0.05),)

    def motion(self, x, u, p):
        return {"bearing": Motion(position=u.angle, velocity=x.w)}

    def derivative(self, x, u, p, effort):
        return {"w": (u.torque - effort["bearing"]) / p.J}

    def output(self, x, u, p):
        return {"speed": x.w}


@pytest.fixture(scope="module")
def spun():
    """A motor whose command acts 120 ms late, and whose damping is another one at each voltage."""
    torque = np.repeat([4.0, 6.0, 8.0, 0.0, 4.0], N // 5)
    late = np.concatenate([np.zeros(6), torque[:-6]])
    speed = np.zeros(N)
    for k in range(N - 1):
        rate = (late[k] - 1.7 - (0.2 + 0.02 * late[k]) * speed[k]) / 0.11
        speed[k + 1] = max(speed[k] + DT * rate, 0.0)
    speed += np.random.default_rng(1).normal(0.0, 0.05, N)
    inputs, outputs = (Channel("torque", "N·m", "zoh"),), (Channel("speed", "rad/s"),)
    return Record("spun", DT * np.arange(N), torque[:, None], speed[:, None], inputs, outputs, simulated=True)


def names(record, model):
    return [one.said for one in hypotheses(model, [record], [])]


def test_what_was_made_of_a_column_is_no_column(spun):
    """It is accused of nothing, and changes with the column that it was made of."""
    record, model = apply_steps(spun, [ANGLE]), compose(Spindle(), ["viscous"])
    assert not [said for said in names(record, model) if "angle" in said]
    speed = next(h for h in hypotheses(model, [record], []) if "sign of output speed" in h.said)
    assert speed.factors == (1.0, -1.0, -1.0), "torque stays, angle and speed are reversed"


def test_what_stands_for_a_column_is_accused_for_it():
    """The velocity that took the place of a recorded acceleration; the position made of it follows."""
    time = 0.01 * np.arange(300)
    both = np.column_stack([np.sin(5 * time), np.cos(3 * time)])
    inputs, outputs = (Channel("force", "N", "zoh"),), (Channel("acceleration", "m/s²"),)
    shaken = Record("shaken", time, both[:, :1], both[:, 1:], inputs, outputs, simulated=True)
    integral = {"step": "integrate", "unit": "m/s", "drift": "mean"}
    made = apply_steps(
        shaken,
        [
            integral | {"signal": "acceleration", "name": "velocity", "demote": True},
            integral | {"signal": "velocity", "name": "position"},
        ],
    )
    found = hypotheses(compose(Pendulum(), []), [made], [])
    assert [one.said for one in found if one.kind == "sign"] == [
        "the sign of input force is reversed",
        "the sign of output velocity is reversed",
    ]
    assert found[1].factors == (1.0, -1.0, -1.0)
    assert [one.order for one in found if one.kind == "swapped"] == [(1, 0, 2)]


@pytest.mark.parametrize("recorded", [False, True])
def test_a_slow_signal_is_not_swapped_with_a_fast_one_because_it_is_easier(spun, recorded):
    """The angle of a motor is its speed's integral: within a horizon it hardly leaves its tangent, so a poor
    model of it leaves a smaller share of its motion than a good model of the speed does."""
    record, model = apply_steps(spun, [ANGLE]), compose(Spindle(), ["viscous", "coulomb"])
    if recorded:
        channels = tuple(replace(one, made_of="") for one in record.input_channels)
        record = replace(record, input_channels=channels)
        assert any("angle and output speed are swapped" in said for said in names(record, model))
    found = judge(model, [record], fit(model, [record], FitSettings(horizon=HORIZON)))
    assert (found.verdict, [one.kind for one in found.findings]) == ("incomplete", ["incomplete"])
