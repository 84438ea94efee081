"""The controller of the electro-mechanical positioning system: a velocity loop inside a position loop."""

from __future__ import annotations

from typing import final

from hybridid.controllers.controller import Controller, Reference, clamped
from hybridid.declarations import Parameter, Signal, State


@final
class EMPSPD(Controller):
    """``force = gain (kp kv (reference - position) - kv velocity + pulses)``, the voltage clamped.

    The velocity is the backward difference of the mean of two positions, ``(q_k - q_k-2) / (2 dt)``. The
    pulses of the validation run are added to the voltage. The amplifier's limit is not published; the
    recorded voltage stays below 9.1 V, and the limit is taken as 10 V.

    Source: Janot, Gautier, Brunot (2019), "Data set and reference models of EMPS", Eqs. (6), (7) and
    Section 2.2; the gains stand in the files of the record.
    """

    name = "emps_pd"
    meaning = "cascaded PD of the EMPS: velocity loop inside a position loop"
    source = "Janot, Gautier, Brunot (2019), Eqs. (6) and (7)"
    references = (
        Reference("reference", "m", "commanded position"),
        Reference("pulses", "V", "added to the voltage", optional=True),
    )
    outputs = (Signal("position", "m", "carriage position"),)
    commands = (Signal("force", "N", "motor force on the load side"),)
    states = (
        State("previous", "m", meaning="position one sample ago"),
        State("oldest", "m", meaning="position two samples ago"),
    )
    parameters = (
        Parameter("kp", "1/s", guess=160.18, meaning="gain of the position loop"),
        Parameter("kv", "V·s/m", guess=243.45, meaning="gain of the velocity loop"),
        Parameter("gain", "N/V", guess=35.15065188, meaning="force of the drive on the load side, per volt"),
        Parameter("limit", "V", guess=10.0, lower=0.0, meaning="voltage at which the amplifier saturates"),
    )
    memory = 2

    def command(self, reference, outputs, state, p):
        velocity = (outputs.position - state.oldest) / (2 * p.dt)
        wanted = p.kp * p.kv * (reference.reference - outputs.position) - p.kv * velocity
        return {"force": p.gain * clamped(wanted + reference.pulses, p.limit)}

    def update(self, reference, outputs, state, p):
        return {"previous": outputs.position, "oldest": state.previous}

    def start(self, reference, outputs, p):
        return {"previous": outputs.position, "oldest": outputs.position}
