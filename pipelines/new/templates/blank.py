"""A machine of one's own: write its equations here."""

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Motion, Plant

STROKE = 1.0  # half the range of the output
SPEED = 1.0  # per s, exceeded 5 % of the time
INPUT = 1.0  # exceeded 5 % of the time
GAIN = SPEED**2 / (STROKE * INPUT)  # the order of magnitude of b


class Machine(Plant):
    """``q'' = b input - F``: a mass that an input pushes. Put your own physics in its place."""

    name = "blank"
    meaning = "a machine of one's own"
    source = "template blank of hybridid"
    states = (
        State("q", "1", scale=STROKE, observed_by="output", derivative=0, meaning="position"),
        State("v", "1/s", scale=SPEED, observed_by="output", derivative=1, meaning="velocity"),
    )
    inputs = (Signal("input", "1", "signal that drives it"),)
    outputs = (Signal("output", "1", "signal that is measured"),)
    parameters = (
        Parameter("b", "1/s²", guess=GAIN, lower=GAIN / 1000, upper=1000 * GAIN, meaning="gain of the input"),
    )
    ports = (
        Port(
            "joint",
            "effort",
            effort_unit="1/s²",
            effort_scale=GAIN * INPUT / 5,
            position_unit="1",
            position_scale=STROKE,
            velocity_scale=SPEED,
            epsilon=SPEED / 500,
            meaning="where friction, springs and dampers may act",
            no_load="not written yet",
        ),
        Port("input", "input", effort_unit="1", effort_scale=INPUT, meaning="actuator"),
        Port("output", "output", effort_unit="1", effort_scale=STROKE, meaning="sensor"),
    )

    def motion(self, x, u, p):
        return {"joint": Motion(position=x.q, velocity=x.v)}

    def derivative(self, x, u, p, effort):
        return {"q": x.v, "v": p.b * u.input - effort["joint"]}

    def output(self, x, u, p):
        return {"output": x.q}
