"""The loop closed over simulated outputs: beside the rig, whose loop is other code, and plain Python."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from hybridid.blame import OwnCodeError
from hybridid.controllers.controller import Controller, Reference, clamped, quantised
from hybridid.controllers.emps_pd import EMPSPD
from hybridid.controllers.loop import Loop
from hybridid.declarations import Parameter, Signal, State
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.records.record import Channel, Record
from hybridid.rigs.emps import EMPSConfig, EMPSRig, EMPSTruth
from hybridid.simulation.closed_loop import closed_loop
from hybridid.simulation.control_law import replayed

DT = 1e-3
GAINS = {"gain": 35.15}
"""Of the rig's drive."""


@pytest.fixture(scope="module")
def record():
    return EMPSRig(EMPSConfig(truth=EMPSTruth())).record("validation", duration=2.0)


@pytest.fixture(scope="module")
def model():
    return compose(EMPS(), ["viscous", "coulomb", "offset"])


@pytest.fixture(scope="module")
def truth(model):
    return model.values(
        {
            "M": 95.0,
            "carriage.viscous.f_v": 203.0,
            "carriage.coulomb.f_c": 20.4,
            "carriage.offset.offset": -3.2,
        }
    )


class Sampled(Controller):
    """A PI law on counts, with a clamp: an integral state that starts with the first reading."""

    name, meaning, source = "sampled", "PI on counts", "this test"
    references = (Reference("reference", "m"),)
    outputs = (Signal("position", "m"),)
    commands = (Signal("force", "N"),)
    parameters = (Parameter("k", "N/m", guess=4e3), Parameter("k_i", "N/(m·s)", guess=2e3))
    states = (State("integral", "m·s"),)

    def _error(self, reference, outputs):
        return reference.reference - quantised(outputs.position, 1e-4)

    def command(self, reference, outputs, state, p):
        return {"force": clamped(p.k * self._error(reference, outputs) + p.k_i * state.integral, 60.0)}

    def update(self, reference, outputs, state, p):
        return {"integral": state.integral + p.dt * self._error(reference, outputs)}

    def start(self, reference, outputs, p):
        return {"integral": 0.01 + outputs.position}


def free_carriage(n, every, delay, phase):
    """The law beside a mass without friction, whose motion over a sample is exact: plain Python."""
    mass, q, v = 80.0, 2e-3, 0.05
    goal = 0.02 * np.sin(2 * np.pi * np.arange(n) * DT) + 0.005
    integral, command, waiting = 0.01 + q, 0.0, [0.0] * delay
    outputs, forces = np.empty(n), np.empty(n)
    for k in range(n):
        outputs[k] = q
        if k % every == phase:
            error = goal[k] - 1e-4 * np.floor(q / 1e-4 + 0.5)
            command = np.clip(4e3 * error + 2e3 * integral, -60, 60)
            integral += every * DT * error
        waiting.append(command)
        forces[k] = waiting.pop(0)
        if k < phase + delay:
            forces[k] = 7.0  # until then the recorded force acts
        q, v = q + DT * v + 0.5 * DT**2 * forces[k] / mass, v + DT * forces[k] / mass
    return goal, outputs, forces


def recorded(goal, outputs, forces, hold="zoh"):
    time = DT * np.arange(len(goal))
    return Record(
        "made", time, forces[:, None], outputs[:, None], (Channel("force", "N", hold),),
        (Channel("position", "m"),), goal[:, None], (Channel("reference", "m"),), simulated=True,
    )  # fmt: skip


def test_the_law_gives_the_rig_s_own_command(record):
    again = replayed(Loop(EMPSPD(), GAINS), record)
    np.testing.assert_allclose(again[2:, 0], record.input("force")[2:], atol=1e-7)


def test_the_true_model_in_the_loop_does_what_the_rig_does(record, model, truth):
    """The rig's dry friction sticks, the model's creeps: they differ where the carriage turns."""
    run = closed_loop(model, truth, record, Loop(EMPSPD(), GAINS), np.array([0.0, 0.0]), 4)
    assert np.sqrt(np.mean((run.outputs - record.outputs) ** 2)) < 1e-6
    assert np.sqrt(np.mean((run.commands - record.inputs) ** 2)) < 0.02 * record.inputs.std()
    heavier = truth * np.where([p.name == "M" for p in model.parameters], 1.2, 1.0)
    other = closed_loop(model, heavier, record, Loop(EMPSPD(), GAINS), np.array([0.0, 0.0]), 4)
    assert np.sqrt(np.mean((other.commands - record.inputs) ** 2)) > 0.05 * record.inputs.std()


@pytest.mark.parametrize(("every", "delay", "phase"), [(1, 0, 0), (5, 0, 0), (1, 3, 0), (5, 2, 0), (5, 2, 3)])
def test_sampling_delay_clamp_counts_and_states_are_those_of_plain_python(every, delay, phase):
    n = 2500  # more than two calls
    goal, outputs, forces = free_carriage(n, every, delay, phase)
    made = recorded(goal, outputs, np.full(n, 7.0))
    model = compose(EMPS(), [])
    loop = Loop(Sampled(), every=every, delay=delay, phase=phase)
    run = closed_loop(model, model.values({"M": 80.0}), made, loop, np.array([2e-3, 0.05]), 2)
    assert np.abs(forces).max() == 60.0
    np.testing.assert_allclose(run.commands[:, 0], forces, atol=1e-6)
    np.testing.assert_allclose(run.outputs[:, 0], outputs, atol=1e-9)
    again = replayed(loop, recorded(goal, outputs, forces))
    np.testing.assert_allclose(again[loop.settled :, 0], forces[loop.settled :], atol=1e-9)


def test_a_command_is_held_whatever_the_record_says_of_its_input(record, model, truth):
    linear = replace(record, input_channels=(replace(record.input_channels[0], hold="foh"),))
    start = np.array([0.0, 0.0])
    held, other = (closed_loop(model, truth, r, Loop(EMPSPD(), GAINS), start, 3) for r in (record, linear))
    np.testing.assert_allclose(other.outputs, held.outputs, atol=1e-12)


def test_inner_states_of_effects_move_in_the_loop(record):
    model = compose(EMPS(), ["viscous", "dahl"])
    values = model.values({"M": 95.0, "carriage.viscous.f_v": 203.0})
    run = closed_loop(model, values, record, Loop(EMPSPD(), GAINS), np.zeros(len(model.states)), 10)
    inner = run.states[:, [s.name.startswith("carriage.dahl") for s in model.states]]
    assert inner.shape[1] >= 1
    assert np.ptp(inner) > 0
    assert np.isfinite(run.outputs).all()


def test_what_a_law_gives_wrongly_is_told_with_its_line(record):
    class Wrong(Sampled):
        def command(self, reference, outputs, state, p):
            return {"torque": outputs.position}

    with pytest.raises(OwnCodeError, match=r"test_closed_loop.py.*command: gives unknown command 'torque'"):
        replayed(Loop(Wrong()), record)

    class Stray(Sampled):
        def start(self, reference, outputs, p):
            return {"integrall": outputs.position}

    with pytest.raises(OwnCodeError, match="unknown state 'integrall': "):
        replayed(Loop(Stray()), record)

    class Unbound(Sampled):
        def command(self, reference, outputs, state, p):
            return {"force": ca.SX.sym("free") * outputs.position}

    with pytest.raises(OwnCodeError, match="free"):
        replayed(Loop(Unbound()), record)
