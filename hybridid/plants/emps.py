"""The electro-mechanical positioning system: a carriage on a ball screw."""

from __future__ import annotations

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant


class EMPS(Plant):
    """``M q'' = force - F``: one mass, driven by a motor's force, resisted at ``carriage``.

    The friction of the thesis (viscous, Coulomb, offset) consists of effects at that port.

    Source: Janot, Gautier, Brunot (2019), "Data set and reference models of EMPS",
    Workshop on Nonlinear System Identification Benchmarks, Eq. (3); thesis Eq. 6-1.
    """

    name = "emps"
    meaning = "electro-mechanical positioning system: motor, ball screw, carriage"
    source = "Janot, Gautier, Brunot (2019), Eq. (3)"
    states = (
        State("q", "m", scale=0.1, observed_by="position", derivative=0, meaning="carriage position"),
        State("v", "m/s", scale=0.1, observed_by="position", derivative=1, meaning="carriage velocity"),
    )
    inputs = (Signal("force", "N", "motor force on the load side"),)
    outputs = (Signal("position", "m", "carriage position"),)
    parameters = (
        Parameter("M", "kg", guess=80.0, lower=1.0, upper=1000.0, meaning="moving mass, load side"),
    )
    ports = (
        Port(
            "carriage",
            "effort",
            effort_unit="N",
            effort_scale=30.0,
            position_unit="m",
            position_scale=0.1,
            velocity_scale=0.1,
            epsilon=3e-4,
            meaning="between carriage and guide, screw and nut",
            drive="motor force through screw and nut",
        ),
        Port("force", "input", effort_unit="N", effort_scale=30.0, meaning="drive command to force"),
        Port("position", "output", effort_unit="m", effort_scale=0.1, meaning="encoder"),
    )

    def motion(self, x, u, p):
        return {"carriage": Motion(position=x.q, velocity=x.v)}

    def loads(self, x, u, p):
        return {"carriage": Load(drive=u.force)}

    def derivative(self, x, u, p, effort):
        return {"q": x.v, "v": (u.force - effort["carriage"]) / p.M}

    def output(self, x, u, p):
        return {"position": x.q}
