"""A pendulum on a motor shaft: a plant as a user writes one, for the tests."""

import casadi as ca

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Motion, Plant


class Pendulum(Plant):
    """``J q'' + G sin q = torque - F``."""

    name, meaning, source = "pendulum", "a pendulum on a motor shaft", "a test"
    states = (
        State("q", "rad", scale=1.0, observed_by="angle", derivative=0),
        State("w", "rad/s", scale=3.0, observed_by="angle", derivative=1),
    )
    inputs = (Signal("torque", "N·m"),)
    outputs = (Signal("angle", "rad"),)
    parameters = (Parameter("J", "kg·m²", 0.05, 0.001, 1.0), Parameter("G", "N·m", 2.0, 0.0, 10.0))
    ports = (Port("pivot", "effort", "N·m", 0.1, "rad", 1.0, 3.0, 0.01),)

    def motion(self, x, u, p):
        return {"pivot": Motion(position=x.q, velocity=x.w)}

    def derivative(self, x, u, p, effort):
        return {"q": x.w, "w": (u.torque - p.G * ca.sin(x.q) - effort["pivot"]) / p.J}

    def output(self, x, u, p):
        return {"angle": x.q}
